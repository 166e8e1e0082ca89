// Device images: targets to draw into and textures to read.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gpu/commands.h"

namespace neuvv::gpu {

struct ImageShape {
    uint32_t width = 1, height = 1;
    VkFormat format = VK_FORMAT_R16G16B16A16_SFLOAT;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    uint32_t mip_levels = 1;
    uint32_t layers = 1;
};

// A two-dimensional image, an array where it has several layers, with one view of all levels and layers. Move-only; the
// device must outlive it. Its layout and contents are undefined after creation.
struct DeviceImage {
    DeviceImage() = default;
    // Throws RuntimeFailure, which names the image, where a limit of the device or its memory is exceeded.
    DeviceImage(const Device& device, std::string name, const ImageShape& shape);
    ~DeviceImage();
    DeviceImage(DeviceImage&& other) noexcept;
    DeviceImage& operator=(DeviceImage&& other) noexcept;

    const Device* device = nullptr;
    std::string name;
    ImageShape shape;
    VkImage image = VK_NULL_HANDLE;
    DeviceMemory memory;
    VkImageView view = VK_NULL_HANDLE;
};

// The defaults are trilinear filtering and repetition.
struct SamplerShape {
    VkSamplerAddressMode wrap_u = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    VkSamplerAddressMode wrap_v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    VkFilter magnification = VK_FILTER_LINEAR;
    VkFilter minification = VK_FILTER_LINEAR;
    bool mipmaps = true;
};

// Move-only.
struct Sampler {
    Sampler() = default;
    Sampler(const Device& device, const std::string& name, const SamplerShape& shape);
    ~Sampler();
    Sampler(Sampler&& other) noexcept;
    Sampler& operator=(Sampler&& other) noexcept;

    const Device* device = nullptr;
    VkSampler sampler = VK_NULL_HANDLE;
};

// Changes the image's layout, where `from` may be UNDEFINED if the contents are no longer needed. It is also a barrier:
// all commands after it see what was written to the image before.
void move_layout(Commands& commands, const DeviceImage& image, VkImageLayout from, VkImageLayout to);
// The same for an image that is not a DeviceImage: one with one colour level and one layer, or the given part.
void move_layout(Commands& commands, VkImage image, VkImageLayout from, VkImageLayout to);
void move_layout(Commands& commands, VkImage image, const VkImageSubresourceRange& part, VkImageLayout from,
                 VkImageLayout to);

// Uploads an image, waits, and leaves it in layout SHADER_READ_ONLY: for set-up. `levels` has the tightly packed bytes
// of each mip level, the largest first.
void upload_levels(const Device& device, const DeviceImage& image, std::span<const std::vector<uint8_t>> levels);

// Copies a part of level 0 of an image in layout TRANSFER_SRC, tightly packed, to a buffer from byte `offset` on.
void copy(Commands& commands, const DeviceImage& from, const VkRect2D& part, const Buffer& to, uint64_t offset = 0);

}  // namespace neuvv::gpu
