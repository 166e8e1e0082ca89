// Converts between the keys of the stage's camera path and the eye.
#pragma once

#include <vector>

#include "stage/camera_path.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

// A key at which the camera sees what the eye sees.
stage::CameraPathKey key_of(const Eye& eye, double time_s);
// The eye that sees as the path's camera does at a time; its pivot is `distance_m` in front of it.
Eye eye_on(const stage::CameraPath& path, double time_s, double distance_m);
// The index of the key that is nearest in time. The path has at least one.
size_t nearest_key(const stage::CameraPath& path, double time_s);
// The path as a cycle, or no longer as one. A cycle that has no time to come back to its first key gets the mean time
// between two keys for it, or a second where it has a single key. A path that is no cycle ends with its last key.
stage::CameraPath with_cyclic(stage::CameraPath path, bool cyclic);

// The points of a line along the path: `steps` from each key to the next, but at most about kMaxLinePoints in all.
// Empty where the path cuts from key to key.
constexpr size_t kMaxLinePoints = 4096;
std::vector<glm::dvec3> line_of(const stage::CameraPath& path, size_t steps);

}  // namespace neuvv::viewer
