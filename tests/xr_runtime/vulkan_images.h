// Images on the application's VkDevice: those of swapchains, and copies of them on the host. Functions that submit work
// wait for it. They may be called only while the application leaves its queue to the runtime.
#pragma once

#include <cstdint>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

// Versions of clang-format wrap this list differently.
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
    VkInstance instance = VK_NULL_HANDLE;
    PFN_vkSubmitDebugUtilsMessageEXT vkSubmitDebugUtilsMessageEXT = nullptr;  // null without VK_EXT_debug_utils
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

// The functions throw std::runtime_error with the name of the Vulkan call that failed.
VulkanDevice open_device(PFN_vkGetInstanceProcAddr load, const XrGraphicsBindingVulkanKHR& binding);
void close_device(VulkanDevice& vulkan);

bool is_depth_format(int64_t format);
VkImageUsageFlags vulkan_usage(const XrSwapchainCreateInfo& info);
// Whether the device supports such images.
bool supports(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info);
// Creates the images, in the layout in which OpenXR hands them out: COLOR_ATTACHMENT_OPTIMAL or
// DEPTH_STENCIL_ATTACHMENT_OPTIMAL.
SwapchainImages create_images(const VulkanDevice& vulkan, const XrSwapchainCreateInfo& info, uint32_t count);
void destroy_images(const VulkanDevice& vulkan, SwapchainImages& images);

// The texels of a rectangle of one array layer, in the image's format, with rows without gaps.
std::vector<uint8_t> read_texels(const VulkanDevice& vulkan, VkImage image, int64_t format, const XrRect2Di& rect,
                                 uint32_t array_layer);
uint32_t bytes_per_texel(int64_t format);

}  // namespace neuvv::xr_runtime
