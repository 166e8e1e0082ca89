// How a viewer moves through the stage: snap turns, teleports, smooth walking. The head itself is wherever it is
// tracked; what moves is the tracking space, which stays upright.
//
// Heads are poses in the tracking space (head_in_tracking). Where an argument is not finite, or a pose not sound
// (is_sound), the rig stays as it was.
#pragma once

#include <optional>
#include <vector>

#include "xr/pose.h"

namespace neuvv::xr {

// Where the tracking space's origin stands in the world, on its floor. (training::Rig is a capture's rig of cameras.)
struct XrRig {
    glm::dvec3 position{0};
    double yaw_rad = 0;  // about +Y
};

Pose world_from_tracking(const XrRig& rig);

// The head stays where it is while the world turns about it. The rig's yaw comes back within ±π.
XrRig turned_about_head(XrRig rig, const Pose& head_in_tracking, double by_rad);

// A teleport: the head comes to be above this point, and the tracking space's floor as high as it. Where a yaw is given
// the head then looks that way (yaw_of), else nothing turns.
XrRig moved_so_that_head_stands_at(XrRig rig, const Pose& head_in_tracking, glm::dvec3 floor_point_world,
                                   std::optional<double> face_yaw_rad = {});

// The path of something thrown along an aim's −Z.
struct Arc {
    // At even distances along it from the hand on, kPointsApart_m or less but not below half of that, more where they
    // would be too many. The last is the landing, if there is one. None where the arguments are not finite.
    std::vector<glm::dvec3> points;
    std::optional<glm::dvec3> landing;
};
constexpr size_t kMostArcPoints = 128;
constexpr double kPointsApart_m = 0.08;
// It ends where it meets the floor from above, or `most_distance_m` along it if it does not by then. Thrown from below
// the floor it may rise through it first.
Arc teleport_arc(const Pose& world_aim, double floor_y, double speed_m_per_s = 6, double most_distance_m = 12);

// Smooth walking: stick up is where the head looks, horizontally. Below `dead_zone` from its middle the stick does
// nothing, from there the speed grows evenly to `metres_per_s` at 1. A late frame counts as kMostStep_s.
constexpr double kMostStep_s = 0.1;
XrRig walked(XrRig rig, const Pose& head_in_tracking, glm::dvec2 stick, double metres_per_s, double dt_s,
             double dead_zone = 0.15);

// How strong a comfort vignette should be: 0 at rest to 1 from kVignetteSpeed_m_per_s or kVignetteTurn_rad_per_s on;
// smooth, and never less for more of either, whatever their signs.
constexpr double kVignetteSpeed_m_per_s = 3, kVignetteTurn_rad_per_s = 1.6;
double vignette_of(double speed_m_per_s, double turn_rad_per_s);

}  // namespace neuvv::xr
