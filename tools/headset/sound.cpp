#include "tools/headset/sound.h"

namespace neuvv::headset {

void play_sound(HeadsetState& state, editor::SoundPlayer& player, const xr::Pose& head) {
    player.set_volume(state.volume_percent / 100);
    stage::EvaluatedStage now = state.evaluated;
    now.time_s = state.clock.time_s();  // the displayed time stands still from frame to frame
    player.follow(state.stage, now, state.clock.playing ? state.clock.speed : 0,
                  glm::mat4(xr::matrix_of(xr::world_from_tracking(state.rig) * head)));
    if (const std::string problem = player.take_problem(); !problem.empty()) state.editor.notify(problem, true);
}

void stop_sound(const HeadsetState& state, editor::SoundPlayer& player) {
    player.follow(state.stage, state.evaluated, 0, glm::mat4(1));
}

}  // namespace neuvv::headset
