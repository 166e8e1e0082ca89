// What the wearer hears of the performers.
#pragma once

#include "editor/sound_player.h"
#include "tools/headset/state/headset_state.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

// To be called in each frame: the stage's sounds follow its clock, for ears at this pose of the head in the tracking
// space. Notifies the user of a sound that cannot be played.
void play_sound(HeadsetState& state, editor::SoundPlayer& player, const xr::Pose& head);
// To be called where there are no frames, as while nobody wears the headset.
void stop_sound(const HeadsetState& state, editor::SoundPlayer& player);

}  // namespace neuvv::headset
