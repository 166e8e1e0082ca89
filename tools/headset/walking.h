// Moving through the stage: a teleport on the left stick, turns on the right one.
#pragma once

#include "tools/headset/hand.h"
#include "tools/headset/on_stage.h"

namespace neuvv::headset {

class Walking {
  public:
    // `free`: the hand's stick does nothing else now. `head` in the tracking space.
    void update(OnStage& on, Hands& hands, const std::array<bool, xr::kHands>& free, const xr::Pose& head, double dt_s);
    // While a teleport is aimed; by hand.
    const xr::Arc* arc() const { return arc_ ? &*arc_ : nullptr; }
    // How dark the edge of the view shall be, 0..1.
    double vignette() const { return vignette_; }

  private:
    void teleport(OnStage& on, Hand& hand, const xr::Pose& head);
    void turn(OnStage& on, Hand& hand, const xr::Pose& head, double dt_s);
    std::optional<xr::Arc> arc_;
    double vignette_ = 0;
};

}  // namespace neuvv::headset
