// Between pixels and the world: rays, projections, and what a pointer drags along lines and planes.
//
// Pixels count as in cameras: x to the right, y down, centres at +0.5. Drags are continuous everywhere: past the point
// where a line vanishes, or above the horizon of a plane, the dragged point stays at kMaxDepthFactor times the depth at
// which it was grabbed.
#pragma once

#include <optional>
#include <utility>

#include "base/box.h"
#include "stage/camera.h"

namespace neuvv::editor {

constexpr double kMaxDepthFactor = 20;

// Whether a pointer has a position: that of ImGui is −FLT_MAX where there is no pointer.
bool is_valid_pointer(glm::dvec2 pointer);

// The ray through a pixel, in the world: that of pick_ray (render/volume/pick.h) in double precision.
Ray ray_through(const stage::Camera& camera, glm::dvec2 pixel);

// The depth of a point: metres in front of the camera along its axis, negative behind it.
double depth_of(const stage::Camera& camera, glm::dvec3 world);

// The pixel that shows a point, which may lie outside the image; nullopt where the point is less than kMinDepth_m in
// front of the camera.
constexpr double kMinDepth_m = 1e-3;
std::optional<glm::dvec2> pixel_of(const stage::Camera& camera, glm::dvec3 world);

// The ends, in pixels, of the part of the segment from a to b that is at least kMinDepth_m in front of the camera;
// nullopt where there is none.
std::optional<std::pair<glm::dvec2, glm::dvec2>> pixels_of(const stage::Camera& camera, glm::dvec3 a, glm::dvec3 b);

// The length in metres of an upright object that stands at this point and is so many pixels high in the image.
double metres_of_pixels(const stage::Camera& camera, glm::dvec3 world, double pixels);

// Drags along a line. Returns s of the point `through + s · along` whose image is nearest to the pointer. `through`
// must be in front of the camera; the pixel that shows it gives s = 0. Nullopt where the line points at the camera:
// where its piece from s = 0 to s = `handle` would be less than kEndOn_px long in the image.
constexpr double kEndOn_px = 8;
std::optional<double> line_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 along, double handle,
                                glm::dvec2 pointer);

// Drags in the plane through `through` with this normal. Returns its point under the pointer. Nullopt where the plane
// is seen edge on: where the sine of the angle between the plane and the line of sight is less than kEdgeOn.
constexpr double kEdgeOn = 0.1;
std::optional<glm::dvec3> plane_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 normal,
                                     glm::dvec2 pointer);

// A unit vector at right angles to v.
glm::dvec3 perpendicular_to(glm::dvec3 v);

// The unit normal of planes that face the camera, which are never seen edge on. It points towards the camera.
glm::dvec3 facing_normal(const stage::Camera& camera);

// With `snap`, the multiple of `step` that is nearest to `value`; else `value`.
double snapped(double value, double step, bool snap);

}  // namespace neuvv::editor
