// A headset's eyes as cameras of this program, the parts of their images that the lenses hide, and the inset.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/rays/ray_grid.h"
#include "stage/camera.h"
#include "xr/session.h"

namespace neuvv::xr {

// The camera of an eye, for an image of `size` pixels. Its focal lengths and its principal point follow from the four
// angles of the eye's field of view: pixels need not be square, and the axis seldom lies in the centre of the image.
// The angles must span an image (spans_image).
stage::Camera eye_camera(const EyeView& eye, const Pose& world_from_tracking, VkExtent2D size);

// The triangles of a view that the lens hides, in the form that SetRaster::hide takes (see corners_in_image). Empty
// where the runtime does not have XR_KHR_visibility_mask, or knows no mesh.
std::vector<glm::vec2> hidden_triangles(const Session& session, uint32_t view, const XrFovf& fov);
// Converts an indexed mesh on the plane one metre before the eye to the corners of triangles in the eye's image, 0..1
// from the upper left. Indices that are left over after the last whole triangle are ignored; where an index is out of
// range the result is empty.
std::vector<glm::vec2> corners_in_image(std::span<const XrVector2f> vertices, std::span<const uint32_t> indices,
                                        const XrFovf& fov);

// The inset that gets all rays: a rectangle that takes `share` of the image's width and height, around the image of
// `looks_at_world`, or around the eye's axis where that is not known or lies behind the eye. It is moved where it would
// leave the image. Outside it, a pixel gets `beside` as many rays along each side.
render::Fovea fovea_of(const stage::Camera& eye, double share, double beside,
                       const std::optional<glm::dvec3>& looks_at_world = {});

}  // namespace neuvv::xr
