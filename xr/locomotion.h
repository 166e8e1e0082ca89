// How a user moves through the stage: snap turns, teleports, smooth walking. The head is wherever it is tracked; what
// moves is the tracking space, which stays upright in the world.
//
// Heads are poses in the tracking space (head_in_tracking). Where an argument is not finite, or a pose is not valid
// (is_valid), the functions return the rig unchanged.
#pragma once

#include <optional>
#include <vector>

#include "xr/pose.h"

namespace neuvv::xr {

// The position and heading of the tracking space's origin, which lies on the floor. (training::Rig is a different
// thing: the cameras of a capture.)
struct XrRig {
    glm::dvec3 position{0};  // world, metres
    double yaw_rad = 0;      // about +Y
};

Pose world_from_tracking(const XrRig& rig);

// Turns the user about their head, which keeps its position in the world. The resulting yaw is within ±π.
XrRig turned_about_head(XrRig rig, const Pose& head_in_tracking, double by_rad);

// Teleports the user: the head comes to be above `floor_point_world`, and the floor of the tracking space at its
// height. Where `face_yaw_rad` is given, the head then looks in that direction (yaw_of); else nothing turns.
XrRig with_head_above(XrRig rig, const Pose& head_in_tracking, glm::dvec3 floor_point_world,
                      std::optional<double> face_yaw_rad = {});

// The rig after a change of the tracking space, so that the user stays in the same place on the stage: for
// `old_from_new`, the new space in the old one, whose tilt and height do not count, as the floor is where the runtime
// says. The user also looks in the same direction.
XrRig in_new_space(const XrRig& rig, const Pose& old_from_new);

// The path of a point thrown along an aim pose's −Z.
struct Arc {
    // World, beginning at the hand and evenly spaced along the path: by at most kArcSpacing_m, or by more where there
    // would be more than kMaxArcPoints. The last point is the landing, if there is one. Empty where an argument is not
    // finite, or where speed or `max_distance_m` are negative or above 1e6.
    std::vector<glm::dvec3> points;
    std::optional<glm::dvec3> landing;
};
constexpr size_t kMaxArcPoints = 128;
constexpr double kArcSpacing_m = 0.08;
// The arc ends where it meets the floor from above, or after `max_distance_m` along its path without a landing. An arc
// that begins below the floor may rise through the floor first.
Arc teleport_arc(const Pose& world_aim, double floor_y, double speed_m_per_s = 6, double max_distance_m = 12);

// Smooth walking: stick up moves the user horizontally to where the head looks. Within `dead_zone` of its centre the
// stick does nothing; from there the speed grows linearly to `metres_per_s` at 1. A frame of more than kMaxStep_s
// counts as kMaxStep_s.
constexpr double kMaxStep_s = 0.1;
XrRig walked(XrRig rig, const Pose& head_in_tracking, glm::dvec2 stick, double metres_per_s, double dt_s,
             double dead_zone = 0.15);

// How much darker an image is drawn for comfort, 0..1.
struct EyeShade {
    double vignette = 0;  // of its edges
    double fade = 0;      // of all but shapes
};

// How strong a comfort vignette should be: from 0 at rest to 1 at kVignetteSpeed_m_per_s or kVignetteTurn_rad_per_s and
// above, which are those of a brisk walk and of half of a usual smooth turn. Smooth, and monotonic in the magnitude of
// each argument.
constexpr double kVignetteSpeed_m_per_s = 1.6, kVignetteTurn_rad_per_s = 0.8;
double vignette_of(double speed_m_per_s, double turn_rad_per_s);

}  // namespace neuvv::xr
