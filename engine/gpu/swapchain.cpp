#include "gpu/swapchain.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace neuvv::gpu {

namespace {

constexpr uint32_t kPreferredImages = 3;
constexpr uint64_t kAcquireTimeout_ns = 20'000'000;
constexpr VkImageUsageFlags kUsage =
    VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

VkSurfaceCapabilitiesKHR capabilities_of(const Device& device, VkSurfaceKHR surface) {
    VkSurfaceCapabilitiesKHR capabilities{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical(), surface, &capabilities),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR", "window");
    return capabilities;
}

// The size that the window reports, or else that of the framebuffer, within the limits of the window.
VkExtent2D extent_for(const VkSurfaceCapabilitiesKHR& capabilities, VkExtent2D framebuffer) {
    if (capabilities.currentExtent.width != UINT32_MAX) return capabilities.currentExtent;
    return {std::clamp(framebuffer.width, capabilities.minImageExtent.width, capabilities.maxImageExtent.width),
            std::clamp(framebuffer.height, capabilities.minImageExtent.height, capabilities.maxImageExtent.height)};
}

VkSemaphore make_semaphore(const Device& device, const std::string& name) {
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    check(vkCreateSemaphore(device.handle(), &info, nullptr, &semaphore), "vkCreateSemaphore", name);
    device.name_object(VK_OBJECT_TYPE_SEMAPHORE, reinterpret_cast<uint64_t>(semaphore), name);
    return semaphore;
}

}  // namespace

Swapchain::Swapchain(const Device& device, VkSurfaceKHR surface, PresentPace pace)
    : device_(device), surface_(surface), pace_(pace) {
    VkBool32 supported = VK_FALSE;
    check(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queue_family(), surface, &supported),
          "vkGetPhysicalDeviceSurfaceSupportKHR", "window");
    if (!supported)
        throw RuntimeFailure(fmt::format("device \"{}\" cannot show images in this window", device.summary().name));
    if ((capabilities_of(device, surface).supportedUsageFlags & kUsage) != kUsage)
        throw RuntimeFailure(fmt::format("device \"{}\" cannot copy images into this window", device.summary().name));
    choose_format();
    if (pace == PresentPace::kFree) choose_mode();
}

Swapchain::~Swapchain() {
    destroy_images();
    vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
    vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

void Swapchain::choose_format() {
    uint32_t count = 0;
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, nullptr),
          "vkGetPhysicalDeviceSurfaceFormatsKHR", "window");
    std::vector<VkSurfaceFormatKHR> formats(count);
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, formats.data()),
          "vkGetPhysicalDeviceSurfaceFormatsKHR", "window");
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
        for (const VkSurfaceFormatKHR& format : formats)
            if (format_ == VK_FORMAT_UNDEFINED && format.format == wanted &&
                format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                format_ = wanted;
    if (format_ == VK_FORMAT_UNDEFINED)
        throw RuntimeFailure("the window offers no 8-bit sRGB colours (B8G8R8A8 or R8G8B8A8)");
}

void Swapchain::choose_mode() {
    uint32_t count = 0;
    check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, nullptr),
          "vkGetPhysicalDeviceSurfacePresentModesKHR", "window");
    std::vector<VkPresentModeKHR> modes(count);
    check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, modes.data()),
          "vkGetPhysicalDeviceSurfacePresentModesKHR", "window");
    for (const VkPresentModeKHR wanted : {VK_PRESENT_MODE_IMMEDIATE_KHR, VK_PRESENT_MODE_MAILBOX_KHR})
        if (std::find(modes.begin(), modes.end(), wanted) != modes.end())
            mode_ = wanted;  // the last one is preferred: it does not tear
}

void Swapchain::destroy_images() {
    device_.wait_idle_or_lost();
    for (VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
    for (auto* semaphores : {&acquired_, &drawn_}) {
        for (VkSemaphore semaphore : *semaphores) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
        semaphores->clear();
    }
    views_.clear();
    images_.clear();
}

void Swapchain::resize(VkExtent2D framebuffer) {
    destroy_images();
    outdated_ = false;
    const VkSurfaceCapabilitiesKHR capabilities = capabilities_of(device_, surface_);
    extent_ = extent_for(capabilities, framebuffer);
    if (extent_.width == 0 || extent_.height == 0) return;
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = std::max(kPreferredImages, capabilities.minImageCount);
    if (capabilities.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
    info.imageFormat = format_;
    info.imageColorSpace = VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
    info.imageExtent = extent_;
    info.imageArrayLayers = 1;
    info.imageUsage = kUsage;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = capabilities.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = mode_;
    info.clipped = VK_TRUE;
    info.oldSwapchain = swapchain_;
    VkSwapchainKHR next = VK_NULL_HANDLE;
    check(vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &next), "vkCreateSwapchainKHR", "window");
    vkDestroySwapchainKHR(device_.handle(), std::exchange(swapchain_, next), nullptr);
    uint32_t count = 0;
    check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR", "window");
    images_.resize(count);
    check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()), "vkGetSwapchainImagesKHR",
          "window");
    for (VkImage image : images_) {
        VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        view.image = image;
        view.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view.format = format_;
        view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        check(vkCreateImageView(device_.handle(), &view, nullptr, &views_.emplace_back()), "vkCreateImageView",
              "window");
    }
    make_semaphores();
}

// There is one more semaphore for acquired images than images: such a semaphore is free again only after the frame that
// waited for it.
void Swapchain::make_semaphores() {
    for (size_t i = 0; i <= images_.size(); ++i) acquired_.push_back(make_semaphore(device_, "window acquired"));
    for (size_t i = 0; i < images_.size(); ++i) drawn_.push_back(make_semaphore(device_, "window drawn"));
    next_acquired_ = 0;
}

std::optional<PresentTarget> Swapchain::acquire(CommandSemaphores& semaphores) {
    if (images_.empty()) return std::nullopt;
    const VkSemaphore acquired = acquired_[next_acquired_];
    uint32_t index = 0;
    const uint64_t timeout_ns = pace_ == PresentPace::kFree ? 0 : kAcquireTimeout_ns;
    const VkResult result =
        vkAcquireNextImageKHR(device_.handle(), swapchain_, timeout_ns, acquired, VK_NULL_HANDLE, &index);
    outdated_ |= result == VK_ERROR_OUT_OF_DATE_KHR;
    if (outdated_ || result == VK_TIMEOUT || result == VK_NOT_READY) return std::nullopt;
    if (result != VK_SUBOPTIMAL_KHR) check(result, "vkAcquireNextImageKHR", "window");
    next_acquired_ = (next_acquired_ + 1) % acquired_.size();
    semaphores = {acquired, drawn_[index]};
    return PresentTarget{images_[index], views_[index], index, extent_};
}

void Swapchain::present(const PresentTarget& target) {
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &drawn_[target.index];
    info.swapchainCount = 1;
    info.pSwapchains = &swapchain_;
    info.pImageIndices = &target.index;
    const std::lock_guard lock(device_.queue_mutex());
    const VkResult result = vkQueuePresentKHR(device_.queue(), &info);
    outdated_ |= result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
    if (!outdated_) check(result, "vkQueuePresentKHR", "window");
}

}  // namespace neuvv::gpu
