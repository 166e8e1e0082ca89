// How a sound reaches two loudspeakers from where it is: quieter the farther away it is, and from its side.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace neuvv::stage {

constexpr double kUsualDistance_m = 2;  // at which a sound is as loud as its file; nearer, it is not louder

// As sound spreads in the open, half as loud at twice the distance (the inverse distance clamped model of OpenAL 1.1).
double distance_gain(double distance_m);

// The gains of the left and of the right loudspeaker for a sound at a place in the frame of an ear or a camera: +X is
// right, +Y up, it looks along −Z. They go from all to the left over both alike to all to the right by the sine of the
// azimuth, the sum of their squares is the square of distance_gain(), and where the place moves they never jump. What
// is behind is heard as what is ahead, and what is right above, below or at the ear from both sides.
std::array<float, 2> pan_gains(const glm::dvec3& place_in_ear);

}  // namespace neuvv::stage
