#include "xr/draw/swapchain.h"

#include <fmt/format.h>

#include <algorithm>

namespace neuvv::xr {

SwapchainImages::SwapchainImages(const Session& session, const gpu::Device& device, std::string name,
                                 const SwapchainShape& shape)
    : device_(device), name_(std::move(name)), shape_(shape) {
    const auto offered = enumerate("xrEnumerateSwapchainFormats", name_, int64_t{},
                                   [&](uint32_t capacity, uint32_t* count, int64_t* all) {
                                       return xrEnumerateSwapchainFormats(session.handle(), capacity, count, all);
                                   });
    for (const int64_t format : offered) {
        const auto known = std::find(shape.formats.begin(), shape.formats.end(), static_cast<VkFormat>(format));
        if (known != shape.formats.end() && create(session, *known)) break;
    }
    if (swapchain_.get() == XR_NULL_HANDLE)
        throw RuntimeFailure(fmt::format("{} has no format of images for \"{}\" that this program can draw",
                                         session.runtime().name(), name_));
    const auto images =
        enumerate("xrEnumerateSwapchainImages", name_, XrSwapchainImageVulkanKHR{XR_TYPE_SWAPCHAIN_IMAGE_VULKAN_KHR},
                  [&](uint32_t capacity, uint32_t* count, XrSwapchainImageVulkanKHR* all) {
                      return xrEnumerateSwapchainImages(handle(), capacity, count,
                                                        reinterpret_cast<XrSwapchainImageBaseHeader*>(all));
                  });
    for (const auto& one : images) {
        images_.push_back(one.image);
        VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        info.image = one.image;
        info.viewType = shape_.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
        info.format = format_;
        info.subresourceRange = {shape_.aspect, 0, 1, 0, shape_.layers};
        gpu::check(vkCreateImageView(device_.handle(), &info, nullptr, &views_.emplace_back()), "vkCreateImageView",
                   name_);
    }
}

SwapchainImages::~SwapchainImages() {
    for (VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
}

bool SwapchainImages::create(const Session& session, VkFormat format) {
    XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
    info.usageFlags = shape_.usage;
    info.format = format;
    info.sampleCount = 1;
    info.width = shape_.size.width;
    info.height = shape_.size.height;
    info.faceCount = 1;
    info.arraySize = shape_.layers;
    info.mipCount = 1;
    const std::lock_guard lock(device_.queue_mutex());
    const XrResult result = xrCreateSwapchain(session.handle(), &info, swapchain_.out());
    if (result == XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED || result == XR_ERROR_FEATURE_UNSUPPORTED) return false;
    check(result, "xrCreateSwapchain", name_);
    format_ = format;
    return true;
}

uint32_t SwapchainImages::acquire() {
    uint32_t index = 0;
    {
        const std::lock_guard lock(device_.queue_mutex());
        check(xrAcquireSwapchainImage(handle(), nullptr, &index), "xrAcquireSwapchainImage", name_);
    }
    const XrSwapchainImageWaitInfo info{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
    check(xrWaitSwapchainImage(handle(), &info), "xrWaitSwapchainImage", name_);
    return index;
}

void SwapchainImages::release() {
    const std::lock_guard lock(device_.queue_mutex());
    check(xrReleaseSwapchainImage(handle(), nullptr), "xrReleaseSwapchainImage", name_);
}

XrSwapchainSubImage SwapchainImages::sub_image(uint32_t layer, VkExtent2D part) const {
    return {handle(), {{0, 0}, {static_cast<int32_t>(part.width), static_cast<int32_t>(part.height)}}, layer};
}

}  // namespace neuvv::xr
