#include "gpu/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace neuvv::gpu {

namespace {

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

void create_image(DeviceImage& to) {
    const Device& device = *to.device;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = to.shape.format;
    info.extent = {to.shape.width, to.shape.height, 1};
    info.mipLevels = to.shape.mip_levels;
    info.arrayLayers = to.shape.layers;
    info.samples = to.shape.samples;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = to.shape.usage;
    check(vkCreateImage(device.handle(), &info, nullptr, &to.image), "vkCreateImage", to.name);
    VkMemoryRequirements requirements{};
    vkGetImageMemoryRequirements(device.handle(), to.image, &requirements);
    const uint32_t type = device.memory_type(requirements.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
    device.check_memory(device.memory_pool().take(device.handle(), requirements.size, type, false, to.memory), to.name,
                        requirements.size);
    check(vkBindImageMemory(device.handle(), to.image, to.memory.memory, 0), "vkBindImageMemory", to.name);
}

}  // namespace

// Delegates, so that the destructor frees what was created when a later step throws.
DeviceImage::DeviceImage(const Device& owner, std::string label, const ImageShape& wanted) : DeviceImage() {
    device = &owner;
    name = std::move(label);
    shape = wanted;
    const uint32_t limit = owner.limits().maxImageDimension2D;
    if (shape.width > limit || shape.height > limit)
        throw RuntimeFailure(fmt::format("image \"{}\" is {}×{}, device \"{}\" takes {} a side", name, shape.width,
                                         shape.height, owner.summary().name, limit));
    create_image(*this);
    VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    info.image = image;
    info.viewType = shape.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
    info.format = shape.format;
    info.subresourceRange = {aspect_of(shape.format), 0, shape.mip_levels, 0, shape.layers};
    check(vkCreateImageView(owner.handle(), &info, nullptr, &view), "vkCreateImageView", name);
    owner.name_object(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image), name);
    owner.name_object(VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(memory.memory), name);
    owner.name_object(VK_OBJECT_TYPE_IMAGE_VIEW, reinterpret_cast<uint64_t>(view), name);
}

DeviceImage::~DeviceImage() {
    if (!device) return;
    vkDestroyImageView(device->handle(), view, nullptr);
    vkDestroyImage(device->handle(), image, nullptr);
    device->memory_pool().give(device->handle(), memory);
}

DeviceImage::DeviceImage(DeviceImage&& other) noexcept {
    *this = std::move(other);
}

DeviceImage& DeviceImage::operator=(DeviceImage&& other) noexcept {
    std::swap(device, other.device);
    std::swap(name, other.name);
    std::swap(shape, other.shape);
    std::swap(image, other.image);
    std::swap(memory, other.memory);
    std::swap(view, other.view);
    return *this;
}

Sampler::Sampler(const Device& owner, const std::string& name, const SamplerShape& shape) : device(&owner) {
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.magFilter = shape.magnification;
    info.minFilter = shape.minification;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    info.addressModeU = shape.wrap_u;
    info.addressModeV = shape.wrap_v;
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    info.maxLod = shape.mipmaps ? VK_LOD_CLAMP_NONE : 0.25f;  // with 0 both filters would be the magnification filter
    check(vkCreateSampler(owner.handle(), &info, nullptr, &sampler), "vkCreateSampler", name);
    owner.name_object(VK_OBJECT_TYPE_SAMPLER, reinterpret_cast<uint64_t>(sampler), name);
}

Sampler::~Sampler() {
    if (device) vkDestroySampler(device->handle(), sampler, nullptr);
}

Sampler::Sampler(Sampler&& other) noexcept {
    *this = std::move(other);
}

Sampler& Sampler::operator=(Sampler&& other) noexcept {
    std::swap(device, other.device);
    std::swap(sampler, other.sampler);
    return *this;
}

void move_layout(Commands& commands, VkImage image, const VkImageSubresourceRange& part, VkImageLayout from,
                 VkImageLayout to) {
    // Waits for all stages and accesses: layouts change only a few times a frame.
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = part;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands.handle(), &info);
}

void move_layout(Commands& commands, const DeviceImage& image, VkImageLayout from, VkImageLayout to) {
    const ImageShape& shape = image.shape;
    move_layout(commands, image.image, {aspect_of(shape.format), 0, shape.mip_levels, 0, shape.layers}, from, to);
}

void move_layout(Commands& commands, VkImage image, VkImageLayout from, VkImageLayout to) {
    move_layout(commands, image, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}, from, to);
}

void upload_levels(const Device& device, const DeviceImage& image, std::span<const std::vector<uint8_t>> levels) {
    assert(levels.size() == image.shape.mip_levels && "one array a mip level");
    uint64_t bytes = 0;
    std::vector<VkBufferImageCopy> regions(levels.size());
    for (uint32_t level = 0; level < levels.size(); ++level) {
        regions[level].bufferOffset = bytes;
        regions[level].imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
        regions[level].imageExtent = {std::max(1u, image.shape.width >> level),
                                      std::max(1u, image.shape.height >> level), 1};
        bytes += levels[level].size();
    }
    const Buffer staging(device, image.name + " upload", bytes, MemoryKind::kUpload);
    for (size_t level = 0; level < levels.size(); ++level)
        std::memcpy(staging.as<uint8_t>() + regions[level].bufferOffset, levels[level].data(), levels[level].size());
    run_once(device, image.name + " upload", [&](Commands& commands) {
        move_layout(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        vkCmdCopyBufferToImage(commands.handle(), staging.buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               static_cast<uint32_t>(regions.size()), regions.data());
        move_layout(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    });
}

void copy(Commands& commands, const DeviceImage& from, const VkRect2D& part, const Buffer& to, uint64_t offset) {
    VkBufferImageCopy region{};
    region.bufferOffset = offset;
    region.imageSubresource = {aspect_of(from.shape.format), 0, 0, 1};
    region.imageOffset = {part.offset.x, part.offset.y, 0};
    region.imageExtent = {part.extent.width, part.extent.height, 1};
    vkCmdCopyImageToBuffer(commands.handle(), from.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.buffer, 1, &region);
}

}  // namespace neuvv::gpu
