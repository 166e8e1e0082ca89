// Moving through the stage: teleporting or walking by the left stick, turning by the right one.
#pragma once

#include "tools/headset/hand.h"
#include "tools/headset/headset_state.h"

namespace neuvv::headset {

class Locomotion {
  public:
    // Moves `state.rig`. `stick_free` says for each hand whether its stick has no other use in this frame. `head` is in
    // the tracking space.
    void update(HeadsetState& state, Hands& hands, const std::array<bool, xr::kHands>& stick_free, const xr::Pose& head,
                double dt_s);
    // The arc of the teleport that is being aimed; null while there is none.
    const xr::Arc* arc() const { return arc_ ? &*arc_ : nullptr; }
    // How dark the edges of the image should be, 0..1.
    double vignette() const { return vignette_; }

  private:
    void teleport(HeadsetState& state, Hand& hand, const xr::Pose& head);
    void turn(HeadsetState& state, Hand& hand, const xr::Pose& head, double dt_s);
    std::optional<xr::Arc> arc_;
    double vignette_ = 0;
};

}  // namespace neuvv::headset
