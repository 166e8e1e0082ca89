// A rendered image as linear light and depth, for files that hold such.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "media/exr.h"

namespace neuvv::render {

// The mean of samples × samples rays a pixel: the twin of resolve.comp, before it becomes sRGB. `radiance`
// (premultiplied linear RGB and alpha) and `depth` (metres) are rows of rays, as FrameRenderer::radiance() and depth()
// give them; depth is the mean by alpha, infinite where nothing is seen. `background`: linear RGB and opacity, behind
// the colour alone.
media::LinearImage linear_image(std::span<const glm::vec4> radiance, std::span<const float> depth, uint32_t width,
                                uint32_t height, uint32_t samples, const glm::vec4& background = glm::vec4(0));

}  // namespace neuvv::render
