// The wearer's body in the world of the stage.
#pragma once

#include "xr/actions.h"
#include "xr/body_tracking.h"
#include "xr/hand_tracking.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

class WearerBody {
  public:
    // `session`, `actions` and `hands` must outlive this object. Throws XrFailure where session or instance are lost.
    WearerBody(const xr::Session& session, const xr::Actions& actions, const xr::HandTracking& hands)
        : tracker_(session), actions_(actions), hands_(hands) {}

    xr::BodySource source() const { return tracker_.source(); }
    // The pose at `time`, in the world, metres; nothing while the body is not tracked. `head` is in the tracking space.
    // To be called after Actions::sample, which gave `inputs`, and HandTracking::locate for the same time.
    std::optional<motion::Pose> locate(const xr::HandInputs& inputs, const std::optional<xr::Pose>& head,
                                       const xr::XrRig& rig, XrTime time) const;

  private:
    xr::BodyTracker tracker_;
    const xr::Actions& actions_;
    const xr::HandTracking& hands_;
};

}  // namespace neuvv::headset
