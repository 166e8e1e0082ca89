// A headset's eyes as this program's cameras, and what of their images the lenses hide.
#pragma once

#include <span>
#include <vector>

#include "render/ray_grid.h"
#include "stage/camera.h"
#include "xr/session.h"

namespace neuvv::xr {

// Pixels are not square where the runtime's angles are not in the image's proportion; the axis lies where the angles
// say, seldom in the middle. Its angles span an image.
stage::Camera eye_camera(const EyeView& eye, const Pose& world_from_tracking, VkExtent2D size);

// Triangles that the lens hides, as SetRaster::hide takes them; none where the runtime knows none.
std::vector<glm::vec2> hidden_corners(const Session& session, uint32_t eye, const XrFovf& fov);
// A mesh on the plane one metre before the eye as triangles in shares of its image from the upper left; whole
// triangles alone, none of a mesh whose indices lie beside its vertices.
std::vector<glm::vec2> corners_in_image(std::span<const XrVector2f> vertices, std::span<const uint32_t> indices,
                                        const XrFovf& fov);

// The inset around the eye's axis that gets all rays, `share` of the image a side; beside it `beside` of them.
render::Fovea fovea_of(const stage::Camera& eye, double share, double beside);

}  // namespace neuvv::xr
