// Images on the application's VkDevice: swapchains, and copies of them for images. Every function that submits work
// waits for it, and must be called only where the application has left its queue to the runtime.
#pragma once

#include <cstdint>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

// clang-format would wrap this list in another way each time.
// clang-format off
#define NEUVV_XR_VULKAN_FUNCTIONS(_) \
    _(vkAllocateCommandBuffers) _(vkAllocateMemory) _(vkBeginCommandBuffer) _(vkBindBufferMemory) \
    _(vkBindImageMemory) _(vkCmdCopyImageToBuffer) _(vkCmdPipelineBarrier) _(vkCreateBuffer) \
    _(vkCreateCommandPool) _(vkCreateFence) _(vkCreateImage) _(vkDestroyBuffer) _(vkDestroyCommandPool) \
    _(vkDestroyFence) _(vkDestroyImage) _(vkEndCommandBuffer) _(vkFreeMemory) _(vkGetBufferMemoryRequirements) \
    _(vkGetDeviceQueue) _(vkGetImageMemoryRequirements) _(vkMapMemory) _(vkQueueSubmit) _(vkResetFences) \
    _(vkUnmapMemory) _(vkWaitForFences)
// clang-format on

struct VulkanDevice {
    VkDevice device = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory = {};
    PFN_vkGetPhysicalDeviceImageFormatProperties vkGetPhysicalDeviceImageFormatProperties = nullptr;
#define NEUVV_XR_MEMBER(name) PFN_##name name = nullptr;
    NEUVV_XR_VULKAN_FUNCTIONS(NEUVV_XR_MEMBER)
#undef NEUVV_XR_MEMBER
};

struct SwapchainImages {
    std::vector<VkImage> images;
    std::vector<VkDeviceMemory> memory;
    bool is_depth = false;
};

// All throw std::runtime_error naming the Vulkan call that failed.
VulkanDevice open_device(PFN_vkGetInstanceProcAddr load, const XrGraphicsBindingVulkanKHR& binding);
void close_device(VulkanDevice& vulkan);

bool is_depth_format(int64_t format);
VkImageUsageFlags vulkan_usage(const XrSwapchainCreateInfo& info);
// Whether the device has images as these.
bool supports(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info);
// In the layout in which OpenXR hands out images: COLOR_ATTACHMENT_OPTIMAL or DEPTH_STENCIL_ATTACHMENT_OPTIMAL.
SwapchainImages create_images(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info, uint32_t count);
void destroy_images(const VulkanDevice& vulkan, SwapchainImages& images);

// The texels of a rectangle of one array layer, rows without gaps, as they lie in memory.
std::vector<uint8_t> read_texels(const VulkanDevice& vulkan, VkImage image, int64_t format, const XrRect2Di& rect,
                                 uint32_t array_layer);
uint32_t bytes_per_texel(int64_t format);

}  // namespace neuvv::xr_runtime
