// The camera path as the viewer has it: at hand by keys, in the image, to look along.
#pragma once

#include "tools/viewer/timeline/camera_keys.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

// The middle of the performers is what the eye turns about then.
Eye eye_at(const stage::CameraPath& path, double time_s, const Viewer& viewer);
// Enter and Shift+Enter: the present view becomes a key at the present time; the nearest key goes.
void add_key_here(Viewer& viewer);
void remove_key_near(Viewer& viewer);
// In the image: the path, its keys as pyramids of sight, and where its camera is now.
void draw_camera_path(const Viewer& viewer, const stage::CameraPath& path, const std::vector<glm::dvec3>& line);

}  // namespace neuvv::viewer
