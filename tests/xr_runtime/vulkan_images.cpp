#include "vulkan_images.h"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

namespace neuvv::xr_runtime {

namespace {

void check(VkResult result, const char* function) {
    if (result != VK_SUCCESS) throw std::runtime_error(fmt::format("{} gave {}", function, static_cast<int>(result)));
}

uint32_t memory_type(const VulkanDevice& vulkan, uint32_t allowed, VkMemoryPropertyFlags wanted) {
    for (uint32_t i = 0; i < vulkan.memory.memoryTypeCount; ++i)
        if ((allowed >> i & 1) && (vulkan.memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    throw std::runtime_error("no Vulkan memory type fits");
}

VkDeviceMemory allocate(const VulkanDevice& vulkan, const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) {
    const VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size,
                                       memory_type(vulkan, needs.memoryTypeBits, wanted)};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    check(vulkan.vkAllocateMemory(vulkan.device, &info, nullptr, &memory), "vkAllocateMemory");
    return memory;
}

VkImageAspectFlags aspect(bool is_depth) {
    return is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}
VkImageLayout attachment_layout(bool is_depth) {
    return is_depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
}

void begin_commands(const VulkanDevice& vulkan) {
    const VkCommandBufferBeginInfo info = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr,
                                           VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vulkan.vkBeginCommandBuffer(vulkan.commands, &info), "vkBeginCommandBuffer");
}

void submit_and_wait(const VulkanDevice& vulkan) {
    check(vulkan.vkEndCommandBuffer(vulkan.commands), "vkEndCommandBuffer");
    VkSubmitInfo info = {VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &vulkan.commands;
    check(vulkan.vkQueueSubmit(vulkan.queue, 1, &info, vulkan.fence), "vkQueueSubmit");
    check(vulkan.vkWaitForFences(vulkan.device, 1, &vulkan.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vulkan.vkResetFences(vulkan.device, 1, &vulkan.fence), "vkResetFences");
}

// A full barrier: all work before it ends before any work after it starts. Correct images matter more than speed here.
void move_image(const VulkanDevice& vulkan, VkImage image, bool is_depth, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier barrier = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {aspect(is_depth), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    vulkan.vkCmdPipelineBarrier(vulkan.commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                                0, 0, nullptr, 0, nullptr, 1, &barrier);
}

VkImageCreateInfo image_info(const XrSwapchainCreateInfo& info) {
    VkImageCreateInfo image = {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    if (info.usageFlags & XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT) image.flags |= VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = static_cast<VkFormat>(info.format);
    image.extent = {info.width, info.height, 1};
    image.mipLevels = info.mipCount;
    image.arrayLayers = info.arraySize;
    image.samples = static_cast<VkSampleCountFlagBits>(info.sampleCount);
    image.tiling = VK_IMAGE_TILING_OPTIMAL;
    image.usage = vulkan_usage(info);
    return image;
}

struct HostBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
};

HostBuffer create_host_buffer(const VulkanDevice& vulkan, size_t bytes) {
    HostBuffer host;
    VkBufferCreateInfo info = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    check(vulkan.vkCreateBuffer(vulkan.device, &info, nullptr, &host.buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vulkan.vkGetBufferMemoryRequirements(vulkan.device, host.buffer, &needs);
    host.memory = allocate(vulkan, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vulkan.vkBindBufferMemory(vulkan.device, host.buffer, host.memory, 0), "vkBindBufferMemory");
    return host;
}

}  // namespace

VulkanDevice open_device(PFN_vkGetInstanceProcAddr load, const XrGraphicsBindingVulkanKHR& binding) {
    VulkanDevice vulkan;
    vulkan.device = binding.device;
    vulkan.physical_device = binding.physicalDevice;
    auto of_instance = [&](const char* name) { return load(binding.instance, name); };
    const auto load_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(of_instance("vkGetDeviceProcAddr"));
#define NEUVV_XR_LOAD(name) vulkan.name = reinterpret_cast<PFN_##name>(load_device(binding.device, #name));
    NEUVV_XR_VULKAN_FUNCTIONS(NEUVV_XR_LOAD)
#undef NEUVV_XR_LOAD
    vulkan.instance = binding.instance;
    vulkan.vkSubmitDebugUtilsMessageEXT =
        reinterpret_cast<PFN_vkSubmitDebugUtilsMessageEXT>(of_instance("vkSubmitDebugUtilsMessageEXT"));
    vulkan.vkGetPhysicalDeviceImageFormatProperties = reinterpret_cast<PFN_vkGetPhysicalDeviceImageFormatProperties>(
        of_instance("vkGetPhysicalDeviceImageFormatProperties"));
    reinterpret_cast<PFN_vkGetPhysicalDeviceMemoryProperties>(of_instance("vkGetPhysicalDeviceMemoryProperties"))(
        binding.physicalDevice, &vulkan.memory);

    vulkan.vkGetDeviceQueue(vulkan.device, binding.queueFamilyIndex, binding.queueIndex, &vulkan.queue);
    const VkCommandPoolCreateInfo pool = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr,
                                          VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT, binding.queueFamilyIndex};
    check(vulkan.vkCreateCommandPool(vulkan.device, &pool, nullptr, &vulkan.pool), "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo commands = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, vulkan.pool,
                                                  VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    check(vulkan.vkAllocateCommandBuffers(vulkan.device, &commands, &vulkan.commands), "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence = {VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vulkan.vkCreateFence(vulkan.device, &fence, nullptr, &vulkan.fence), "vkCreateFence");
    return vulkan;
}

void close_device(VulkanDevice& vulkan) {
    if (!vulkan.device) return;
    vulkan.vkDestroyFence(vulkan.device, vulkan.fence, nullptr);
    vulkan.vkDestroyCommandPool(vulkan.device, vulkan.pool, nullptr);
    vulkan.device = VK_NULL_HANDLE;
}

bool is_depth_format(int64_t format) {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
}

VkImageUsageFlags vulkan_usage(const XrSwapchainCreateInfo& info) {
    const struct {
        XrSwapchainUsageFlags from;
        VkImageUsageFlags to;
    } kUsages[] = {{XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT},
                   {XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
                   {XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT, VK_IMAGE_USAGE_STORAGE_BIT},
                   {XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                   {XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT, VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                   {XR_SWAPCHAIN_USAGE_SAMPLED_BIT, VK_IMAGE_USAGE_SAMPLED_BIT}};
    // The layout in which images are handed out requires the attachment usage, whatever usages the application
    // requests.
    VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    usage |= is_depth_format(info.format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                          : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    for (const auto& pair : kUsages)
        if (info.usageFlags & pair.from) usage |= pair.to;
    return usage;
}

bool supports(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info) {
    const VkImageCreateInfo image = image_info(info);
    VkImageFormatProperties limits;
    if (vulkan.vkGetPhysicalDeviceImageFormatProperties(vulkan.physical_device, image.format, image.imageType,
                                                        image.tiling, image.usage, image.flags, &limits) != VK_SUCCESS)
        return false;
    return image.extent.width <= limits.maxExtent.width && image.extent.height <= limits.maxExtent.height &&
           image.arrayLayers <= limits.maxArrayLayers && image.mipLevels <= limits.maxMipLevels &&
           (image.samples & limits.sampleCounts);
}

SwapchainImages create_images(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info, uint32_t count) {
    SwapchainImages made;
    made.is_depth = is_depth_format(info.format);
    const VkImageCreateInfo create = image_info(info);
    begin_commands(vulkan);
    for (uint32_t i = 0; i < count; ++i) {
        VkImage image = VK_NULL_HANDLE;
        check(vulkan.vkCreateImage(vulkan.device, &create, nullptr, &image), "vkCreateImage");
        made.images.push_back(image);
        VkMemoryRequirements needs;
        vulkan.vkGetImageMemoryRequirements(vulkan.device, image, &needs);
        made.memory.push_back(allocate(vulkan, needs, 0));
        check(vulkan.vkBindImageMemory(vulkan.device, image, made.memory.back(), 0), "vkBindImageMemory");
        move_image(vulkan, image, made.is_depth, VK_IMAGE_LAYOUT_UNDEFINED, attachment_layout(made.is_depth));
    }
    submit_and_wait(vulkan);
    return made;
}

void destroy_images(const VulkanDevice& vulkan, SwapchainImages& images) {
    for (VkImage image : images.images) vulkan.vkDestroyImage(vulkan.device, image, nullptr);
    for (VkDeviceMemory memory : images.memory) vulkan.vkFreeMemory(vulkan.device, memory, nullptr);
    images = {};
}

uint32_t bytes_per_texel(int64_t format) {
    if (format == VK_FORMAT_R16G16B16A16_SFLOAT) return 8;
    return format == VK_FORMAT_D16_UNORM ? 2 : 4;
}

std::vector<uint8_t> read_texels(const VulkanDevice& vulkan, VkImage image, int64_t format, const XrRect2Di& rect,
                                 uint32_t array_layer) {
    const auto width = static_cast<uint32_t>(rect.extent.width), height = static_cast<uint32_t>(rect.extent.height);
    std::vector<uint8_t> texels(size_t{width} * height * bytes_per_texel(format));
    const bool is_depth = is_depth_format(format);
    const HostBuffer host = create_host_buffer(vulkan, texels.size());

    begin_commands(vulkan);
    move_image(vulkan, image, is_depth, attachment_layout(is_depth), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VkBufferImageCopy copy = {};
    copy.imageSubresource = {aspect(is_depth), 0, array_layer, 1};
    copy.imageOffset = {rect.offset.x, rect.offset.y, 0};
    copy.imageExtent = {width, height, 1};
    vulkan.vkCmdCopyImageToBuffer(vulkan.commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, host.buffer, 1, &copy);
    move_image(vulkan, image, is_depth, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, attachment_layout(is_depth));
    const VkMemoryBarrier to_host = {VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_TRANSFER_WRITE_BIT,
                                     VK_ACCESS_HOST_READ_BIT};
    vulkan.vkCmdPipelineBarrier(vulkan.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                                &to_host, 0, nullptr, 0, nullptr);
    submit_and_wait(vulkan);

    void* mapped = nullptr;
    check(vulkan.vkMapMemory(vulkan.device, host.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memcpy(texels.data(), mapped, texels.size());
    vulkan.vkUnmapMemory(vulkan.device, host.memory);
    vulkan.vkDestroyBuffer(vulkan.device, host.buffer, nullptr);
    vulkan.vkFreeMemory(vulkan.device, host.memory, nullptr);
    return texels;
}

}  // namespace neuvv::xr_runtime
