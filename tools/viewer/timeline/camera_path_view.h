// The camera path as the viewer has it: at hand by keys, in the image, to look along.
#pragma once

#include "tools/viewer/context.h"
#include "tools/viewer/timeline/camera_keys.h"

namespace neuvv::viewer {

// The middle of the performers is what the eye turns about then.
Eye eye_at(const stage::CameraPath& path, double time_s, const Context& context);
// Enter and Shift+Enter: the present view becomes a key at the present time; the nearest key goes.
void add_key_here(Context& context);
void remove_nearest_key(Context& context);
// In the image: the path, its keys as pyramids of sight, and where its camera is now.
void draw_camera_path(const Context& context, const stage::CameraPath& path, const std::vector<glm::dvec3>& line);

}  // namespace neuvv::viewer
