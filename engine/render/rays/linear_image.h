// A rendered image as linear light and depth, for files that store them.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "media/exr.h"
#include "stage/camera.h"

namespace neuvv::render {

// Takes the mean of samples × samples rays a pixel, as resolve.comp does before it converts to sRGB. `radiance`
// (premultiplied linear RGB and alpha) and `depth` (metres along the ray) are rows of rays, as
// FrameRenderer::radiance() and depth() return them for this camera. A pixel's depth is that along the camera's axis,
// the mean weighted by alpha, and infinite where all rays are transparent. `background` is linear RGB and opacity, and
// lies behind the colour; it does not affect the depth.
media::LinearImage linear_image(std::span<const glm::vec4> radiance, std::span<const float> depth,
                                const stage::Camera& camera, uint32_t samples,
                                const glm::vec4& background = glm::vec4(0));

// The factor by which a length along a ray becomes one along the camera's axis. `rays` is the camera enlarged so that
// each of its pixels is a ray, which is taken to go through the pixel's centre.
float axis_per_ray(const stage::Camera& rays, glm::uvec2 ray);

}  // namespace neuvv::render
