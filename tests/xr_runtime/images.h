// The images of a frame's layers that are written to NEUVV_XR_OUT: what was submitted, and what a compositor would
// show.
#pragma once

#include <filesystem>

#include "layers.h"

namespace neuvv::xr_runtime {

// Linear light, rows from the top, RGBA.
struct LinearImage {
    uint32_t width = 0, height = 0;
    std::vector<float> rgba;
    const float* at(uint32_t x, uint32_t y) const { return &rgba[(size_t{y} * width + x) * 4]; }
    float* at(uint32_t x, uint32_t y) { return &rgba[(size_t{y} * width + x) * 4]; }
};

// Decodes texels of a format; depth goes to the first channel. UNORM is linear, as the specification says.
LinearImage linear_image(const std::vector<uint8_t>& texels, int64_t format, uint32_t width, uint32_t height);

uint8_t srgb_byte(float linear);

// What an eye sees of the layers. `images` has the eye's image of each layer, in the order of the layers, and `narrow`
// that of its narrow view, where the layer has one.
LinearImage compose(const std::vector<Layer>& layers, const std::vector<LinearImage>& images,
                    const std::vector<LinearImage>& narrow, uint32_t eye, XrTime time, XrEnvironmentBlendMode blend);

void save_images(const VulkanDevice& vulkan, const Frame& frame, const std::vector<Layer>& layers,
                 XrEnvironmentBlendMode blend);

}  // namespace neuvv::xr_runtime
