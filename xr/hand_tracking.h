// Bare hands by XR_EXT_hand_tracking: joints to be seen, and a pinch of thumb and index finger as a trigger.
#pragma once

#include <vector>

#include "xr/hands.h"
#include "xr/session.h"

namespace neuvv::xr {

struct HandJoint {
    glm::dvec3 position{0};  // tracking space
    double radius_m = 0.01;
};
using HandJoints = std::vector<HandJoint>;  // in OpenXR's order, 26; none while the hand is not seen

class HandTracking {
  public:
    // Does nothing where the runtime sees no hands.
    explicit HandTracking(const Session& session);
    ~HandTracking();
    HandTracking(const HandTracking&) = delete;
    HandTracking& operator=(const HandTracking&) = delete;

    void locate(XrTime time);
    const HandJoints& joints(int hand) const { return joints_[hand]; }

  private:
    const Session& session_;
    PFN_xrDestroyHandTrackerEXT destroy_ = nullptr;  // a lost instance finds no functions any more
    std::array<XrHandTrackerEXT, kHands> trackers_{};
    std::array<HandJoints, kHands> joints_;
};

// 0 with the tips of thumb and index finger 5 cm apart, 1 where they touch.
double pinch_of(const HandJoints& joints);

// A hand that is seen without a controller points along its index finger's root and selects by a pinch. Whether it
// does; not where the runtime knows its gestures, though it may not know where it points now.
bool stand_in(HandInput& input, const HandJoints& joints);

}  // namespace neuvv::xr
