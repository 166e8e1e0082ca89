// Between pixels and the world: rays, what is seen where, and what a pointer drags along lines and planes.
//
// Pixels count as Camera's do: x to the right, y down, centres at +0.5. Drags are continuous everywhere: past the point
// where a line vanishes, or above a plane's horizon, what is dragged stays kMaxDepthFactor times as deep as it was
// grabbed.
#pragma once

#include <optional>
#include <utility>

#include "base/box.h"
#include "stage/camera.h"

namespace neuvv::editor {

constexpr double kMaxDepthFactor = 20;

// Whether a pointer is anywhere: ImGui's is −FLT_MAX when it is not.
bool is_valid_pointer(glm::dvec2 pointer);

// The ray of pick_ray (render/pick.h) in double precision, in the world.
Ray ray_through(const stage::Camera& camera, glm::dvec2 pixel);

// Metres in front of the camera, along its axis; negative behind it.
double depth_of(const stage::Camera& camera, glm::dvec3 world);

// Where a point is seen; nothing where it is less than kMinDepth_m in front of the camera. May lie out of the image.
constexpr double kMinDepth_m = 1e-3;
std::optional<glm::dvec2> pixel_of(const stage::Camera& camera, glm::dvec3 world);

// The part of a segment that is in front of the camera, in pixels; nothing where none is.
std::optional<std::pair<glm::dvec2, glm::dvec2>> pixels_of(const stage::Camera& camera, glm::dvec3 a, glm::dvec3 b);

// How long something is, in metres, that stands upright at this place and is seen so many pixels high there.
double metres_of_pixels(const stage::Camera& camera, glm::dvec3 world, double pixels);

// Drags along a line: s of the point `through + s · along` that is seen nearest to the pointer, nearest on the line as
// it appears in the image. `through` is in front of the camera, where it is seen s is 0. Nothing where the line is
// seen end on: where its piece from s = 0 to `shown` were less than kEndOn_px long in the image.
constexpr double kEndOn_px = 8;
std::optional<double> line_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 along, double handle,
                                glm::dvec2 pointer);

// Drags in a plane: its point under the pointer. Nothing where the plane is seen edge on: where the sine of the
// angle between it and the line of sight is less than kEdgeOn.
constexpr double kEdgeOn = 0.1;
std::optional<glm::dvec3> plane_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 normal,
                                     glm::dvec2 pointer);

// Some unit vector at right angles to another vector.
glm::dvec3 perpendicular_to(glm::dvec3 v);

// Facing the camera: never edge on. The unit normal points to the camera.
glm::dvec3 facing_normal(const stage::Camera& camera);

// `value` or the multiple of `step` that is nearest to it.
double snapped(double value, double step, bool snap);

}  // namespace neuvv::editor
