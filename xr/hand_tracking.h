// Bare hands by XR_EXT_hand_tracking: joints to be drawn, and a pinch of thumb and index finger as a trigger.
#pragma once

#include <vector>

#include "xr/hands.h"
#include "xr/session.h"

namespace neuvv::xr {

struct HandJoint {
    glm::dvec3 position{0};  // tracking space
    double radius_m = 0.01;
};
using HandJoints = std::vector<HandJoint>;  // 26 joints in OpenXR's order; empty while the hand is not tracked

class HandTracking {
  public:
    // Where the runtime does not track hands, all hands stay without joints. The session must outlive this object.
    explicit HandTracking(const Session& session);
    ~HandTracking();
    HandTracking(const HandTracking&) = delete;
    HandTracking& operator=(const HandTracking&) = delete;

    // Updates joints() to `time`.
    void locate(XrTime time);
    const HandJoints& joints(int hand) const { return joints_[hand]; }

  private:
    const Session& session_;
    PFN_xrDestroyHandTrackerEXT destroy_ = nullptr;  // fetched early: a lost instance returns no functions
    std::array<XrHandTrackerEXT, kHands> trackers_{};
    std::array<HandJoints, kHands> joints_;
};

// The strength of a pinch: 0 where the tips of thumb and index finger are 5 cm apart or more, 1 from 1.5 cm on; 0 for a
// hand without joints.
double pinch_of(const HandJoints& joints);

// Fills the input of a hand that is tracked, but has no controller, from its joints: the hand points from its wrist
// through the root of its index finger and selects by a pinch. Returns whether it did. Leaves the input as it is where
// it has an aim pose, or where the runtime itself recognises the gestures of bare hands (even while it has no aim
// pose).
bool fill_from_joints(HandInput& input, const HandJoints& joints);

}  // namespace neuvv::xr
