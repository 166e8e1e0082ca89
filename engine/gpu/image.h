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

// Move-only; two-dimensional, an array where it has several layers, with one view of the whole. Layout and contents are
// undefined after creation.
struct DeviceImage {
    DeviceImage() = default;
    // Throws RuntimeFailure naming the image where a limit of the device or its memory is exceeded.
    DeviceImage(const Device& device, std::string name, const ImageShape& shape);
    ~DeviceImage();
    DeviceImage(DeviceImage&& other) noexcept;
    DeviceImage& operator=(DeviceImage&& other) noexcept;

    const Device* device = nullptr;
    std::string name;
    ImageShape shape;
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
};

// Trilinear unless told otherwise.
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

// What was done with the image before, in layout `from` (UNDEFINED drops its contents), is seen by all that comes
// after.
void move_layout(Commands& commands, const DeviceImage& image, VkImageLayout from, VkImageLayout to);
// Of a colour image of one level that is somebody else's; another one by its aspects and layers.
void move_layout(Commands& commands, VkImage image, VkImageLayout from, VkImageLayout to);
void move_layout(Commands& commands, VkImage image, const VkImageSubresourceRange& part, VkImageLayout from,
                 VkImageLayout to);

// One tightly packed array of bytes a mip level, the largest first. The layout becomes SHADER_READ_ONLY; set-up only.
void upload_levels(const Device& device, const DeviceImage& image, std::span<const std::vector<uint8_t>> levels);

// A part of level 0, in layout TRANSFER_SRC, tightly packed into a buffer from byte `offset` on.
void copy(Commands& commands, const DeviceImage& from, const VkRect2D& part, const Buffer& to, uint64_t offset = 0);

}  // namespace neuvv::gpu
