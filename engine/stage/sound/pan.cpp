#include "stage/sound/pan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::stage {

namespace {

constexpr double kHead_m = 0.1;  // within it, sounds move to the middle

}  // namespace

double distance_gain(double distance_m) {
    return kUsualDistance_m / std::max(distance_m, kUsualDistance_m);
}

// By the whole distance, not only by that along the floor: so the side fades where a sound passes overhead.
std::array<float, 2> pan_gains(const glm::dvec3& place_in_ear) {
    const double distance_m = glm::length(place_in_ear);
    const double to_right = place_in_ear.x / std::max(distance_m, kHead_m);  // −1 to 1
    const double angle = (to_right + 1) * std::numbers::pi / 4;
    const double gain = distance_gain(distance_m);
    return {static_cast<float>(gain * std::cos(angle)), static_cast<float>(gain * std::sin(angle))};
}

}  // namespace neuvv::stage
