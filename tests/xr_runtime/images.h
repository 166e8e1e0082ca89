// The images in NEUVV_XR_OUT of a frame's layers: what was submitted, and what a compositor would show.
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

// As their formats lay them out; depth in the first channel. UNORM counts as linear, as the specification has it.
LinearImage linear_image(const std::vector<uint8_t>& texels, int64_t format, uint32_t width, uint32_t height);

uint8_t srgb_byte(float linear);

// What an eye sees of the layers, whose images stand in their order, for each the eye's own.
LinearImage compose(const std::vector<Layer>& layers, const std::vector<LinearImage>& images, uint32_t eye,
                    XrTime time);

void save_images(const VulkanDevice& vulkan, const Frame& frame, const std::vector<Layer>& layers);

}  // namespace neuvv::xr_runtime
