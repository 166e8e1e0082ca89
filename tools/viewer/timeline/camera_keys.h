// The stage's camera path, between its keys and the eye.
#pragma once

#include <vector>

#include "stage/camera_path.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

stage::CameraPathKey key_of(const Eye& eye, double time_s);
// The eye that sees as the path's camera does; the pivot `distance_m` in front of it.
Eye eye_on(const stage::CameraPath& path, double time_s, double distance_m);
// The key that is nearest in time, of at least one.
size_t nearest_key(const stage::CameraPath& path, double time_s);
// A cycle comes back to its first key in the time that it takes from key to key, one of a single key in a second; a
// path that is none any more ends with its last key.
stage::CameraPath with_cyclic(stage::CameraPath path, bool cyclic);

// What a line through all places of a path joins: `steps` points from key to key. Nothing for cuts.
constexpr size_t kMaxLinePoints = 4096;
std::vector<glm::dvec3> line_of(const stage::CameraPath& path, size_t steps);

}  // namespace neuvv::viewer
