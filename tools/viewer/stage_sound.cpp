#include "tools/viewer/stage_sound.h"

namespace neuvv::viewer {

void StageSound::follow(Context& context) {
    const ViewState& view = context.view;
    const std::shared_ptr<const stage::Stage>& stage = context.frame.stage;
    const double speed = view.clock.playing && view.sound ? view.clock.speed : 0;
    stage::EvaluatedStage now = context.frame.evaluated;
    now.time_s = view.clock.time_s();  // the displayed time stands still from frame to frame
    for (stage::EvaluatedPerformer& performer : now.performers)
        performer.visible &= stage && view.hears(stage->performers[performer.performer].name);
    player.follow(stage, now, speed, glm::mat4(world_from_eye(view.eye)));
    for (const std::string& problem : {player.take_problem(), waveforms.take_problem()})
        if (!problem.empty()) context.editor.notify(problem, true);
}

}  // namespace neuvv::viewer
