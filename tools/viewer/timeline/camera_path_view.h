// The camera path in the viewer: editing it by keys, drawing it over the image, and looking along it.
#pragma once

#include "tools/viewer/context.h"
#include "tools/viewer/timeline/camera_keys.h"

namespace neuvv::viewer {

// The eye on the path at a time. It turns about a point at the depth of the performers.
Eye eye_at(const stage::CameraPath& path, double time_s, const Context& context);
// Enter and Shift+Enter: makes the current view a key at the displayed time; removes the key that is nearest to it.
void add_key_here(Context& context);
void remove_nearest_key(Context& context);
// Draws the path over the image: the line, the frustums of its keys, and that of its camera at the displayed time.
void draw_camera_path(const Context& context, const stage::CameraPath& path, const std::vector<glm::dvec3>& line);

}  // namespace neuvv::viewer
