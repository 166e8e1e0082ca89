// A rendered image as linear light and depth, for files that store them.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "media/exr.h"

namespace neuvv::render {

// Takes the mean of samples × samples rays a pixel, as resolve.comp does before it converts to sRGB. `radiance`
// (premultiplied linear RGB and alpha) and `depth` (metres) are rows of rays, as FrameRenderer::radiance() and depth()
// return them. A pixel's depth is the mean weighted by alpha, and infinite where all rays are transparent. `background`
// is linear RGB and opacity, and lies behind the colour; it does not affect the depth.
media::LinearImage linear_image(std::span<const glm::vec4> radiance, std::span<const float> depth, uint32_t width,
                                uint32_t height, uint32_t samples, const glm::vec4& background = glm::vec4(0));

}  // namespace neuvv::render
