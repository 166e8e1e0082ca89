// A camera that moves: keys in time, and the camera at any time between them.
#pragma once

#include <cassert>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <vector>

#include "stage/camera.h"

namespace neuvv::stage {

struct CameraPathKey {
    double time_s = 0;
    glm::dvec3 position{0};                    // world, metres
    glm::dquat world_from_camera{1, 0, 0, 0};  // OpenGL axes, as Camera's
    double angle_y = 0.6;                      // the whole vertical angle of view, radians
    std::optional<double> angle_x;             // instead of angle_y where only the horizontal one is known
    double stretch = 1;                        // fx / fy
    glm::dvec2 shift{0};                       // the principal point, right of and below the middle, in image heights
    std::optional<double> clip_time;           // of the performance, 0 first frame … 1 last; absent: it just plays
};

enum class Interpolation {
    kSmooth,
    kLinear,
    kCut,  // each key holds until the next
};

// At least one key, times ascending and not negative. `duration_s` is at least the last key's time: an open path rests
// there; a cyclic path (kCut excepted) is back at its first key then, so that its last key must stand earlier.
struct CameraPath {
    std::vector<CameraPathKey> keys;
    Interpolation interpolation = Interpolation::kSmooth;
    bool cyclic = false;
    double duration_s = 0;
    uint32_t width = 0, height = 0;  // that the path was made for; 0: any
    double fps = 0;                  // likewise
};

// The camera at a time, in an image of this size: the vertical angle of view is the path's. Before the first key
// and after the last an open path rests, a cyclic one goes on.
//
// Smooth: positions follow cubic Hermite curves whose velocity at a key is that of the parabola through it and its
// neighbours (Catmull–Rom for uneven times), at the ends as if the curve were straight there (no acceleration), but
// never above three times that of the slower of the two segments beside it (Fritsch and Carlson 1980). So the path has
// no jump in velocity, goes through its keys, keeps even keys on a line at constant speed, overshoots nothing along a
// line that it follows in one direction, and stands still between equal keys. Orientations do the same by Hermite
// quaternion curves (Kim, Kim and Shin 1995) in angular velocities, each segment the shorter way. Turning from one
// level key to another so would tilt the horizon on the way (a great circle of orientations is not level): the roll is
// therefore interpolated as a number of its own. Its weight fades to 0 where a view comes within 15° to 5° of the
// vertical, where roll means nothing, and at keys from which the roll turns by 45° to 90°, as on a way over the pole.
// Angles of view, lens shifts and times of the clip stop at their extrema: none is exceeded.
//
// Linear: straight lines at constant speed, and constant turns (slerp), level as above.
Camera camera_at(const CameraPath& path, double time_s, uint32_t width, uint32_t height);

// The clip's time then, 0 to 1; none between keys of which one has none.
std::optional<double> clip_time_at(const CameraPath& path, double time_s);

// How far a camera's right side is turned up about its axis of view, −π to π; 0 for a level camera and for one that
// looks straight up or down.
double roll_of(const glm::dquat& world_from_camera);

}  // namespace neuvv::stage
