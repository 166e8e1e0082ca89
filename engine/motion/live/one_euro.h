// The 1€ filter (Casiez et al., CHI 2012): smooths what rests and lets pass what moves fast.
#pragma once

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

struct OneEuroSettings {
    double rest_hz = 2;         // the cut-off of what rests: lower is steadier
    double hz_per_metre_s = 4;  // by which it rises with speed: higher lags less
    double speed_hz = 3;        // the cut-off of the speed itself
    double forget_s = 0.25;     // a joint that was unknown for longer begins anew
};

// Filters each joint of a pose by itself.
class PoseFilter {
  public:
    explicit PoseFilter(const OneEuroSettings& settings = {}) : settings_(settings) {}

    // The filtered pose at a time in seconds. Where time does not advance, the last result.
    Pose filter(const Pose& pose, double time_s);
    void reset() { joints_ = {}; }

  private:
    struct State {
        bool known = false;
        double time_s = 0;
        glm::dvec3 position{0}, speed{0};
    };
    OneEuroSettings settings_;
    std::array<State, kJoints> joints_;
};

}  // namespace neuvv::motion
