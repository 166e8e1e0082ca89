// A moving camera: its keys in time, and the camera interpolated between them.
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
    std::optional<double> angle_x;             // the whole horizontal angle of view; where given, it replaces angle_y
    double stretch = 1;                        // fx / fy
    glm::dvec2 shift{0};                       // the principal point, right of and below the centre, in image heights
    std::optional<double> clip_time;           // 0 first frame of the clip … 1 last; absent: the clip plays normally
};

enum class Interpolation {
    kSmooth,
    kLinear,
    kCut,  // the camera stays at each key until the time of the next
};

constexpr size_t kMaxPathKeys = 65536;  // of a path in a file

// There is at least one key; the keys' times ascend and are not negative. `duration_s` is at least the last key's time.
// An open path stays at its last key from that time on. A cyclic path of several keys is back at its first key
// `duration_s` after it, so its last key must be earlier than `duration_s`.
struct CameraPath {
    std::vector<CameraPathKey> keys;
    Interpolation interpolation = Interpolation::kSmooth;
    bool cyclic = false;
    double duration_s = 0;
    uint32_t width = 0, height = 0;  // pixels of the images that the path was made for; 0: any
    double fps = 0;                  // images per second that the path was made for; 0: any
};

// The camera at a time, for an image of `width` × `height` pixels; the vertical angle of view is the path's. Before its
// first key and after its last, an open path stays at that key; a cyclic path repeats.
//
// kSmooth: positions follow cubic Hermite curves. The velocity at a key is that of the parabola through the key and its
// neighbours (Catmull–Rom for uneven times); at the ends of the path it is chosen so that the acceleration there is 0.
// It is at most three times the mean velocity of the slower of the two segments beside the key (Fritsch and Carlson
// 1980). So the path has no jump in velocity, goes through its keys, passes evenly spaced keys on a line at constant
// speed, does not overshoot along a line that it follows in one direction, and stands still between equal keys.
// Orientations are interpolated in the same manner, by Hermite quaternion curves (Kim, Kim and Shin 1995) with angular
// velocities; each segment turns the shorter way.
//
// Such a curve between two level keys would tilt the horizon in between, because a great circle of orientations is not
// level. The roll is therefore interpolated as a separate number. The weight of this correction fades to 0 where the
// direction of view comes within 15° to 5° of the vertical, where roll is undefined, and at keys from which the roll
// turns by 45° to 90°, as it does when the view passes over the pole. Angles of view, lens shifts and clip times have
// their extrema at keys: no value between two keys lies beyond theirs.
//
// kLinear: straight lines at constant speed, and turns at constant angular velocity (slerp), with the roll corrected as
// above.
Camera camera_at(const CameraPath& path, double time_s, uint32_t width, uint32_t height);

// The key of a camera at a time.
CameraPathKey key_of(const Camera& camera, double time_s);

// The path as images of `width` × `height` pixels: a key for each, image i at i / fps seconds, linear in between. An
// open path ends with the last image that is not later than its last key; a cyclic path stays cyclic. `fps` > 0. Throws
// InputError for more than kMaxPathKeys images.
CameraPath by_images(const CameraPath& path, double fps, uint32_t width, uint32_t height);

// The clip time at `time_s`, 0 to 1; nothing between two keys of which one has no clip time.
std::optional<double> clip_time_at(const CameraPath& path, double time_s);

// The angle by which the camera's right side is turned up about its axis of view, −π to π radians; 0 for a level camera
// and for one that looks straight up or down.
double roll_of(const glm::dquat& world_from_camera);

}  // namespace neuvv::stage
