// Images that go to the headset: acquired, drawn into, released.
#pragma once

#include <string>
#include <vector>

#include "gpu/image.h"
#include "xr/session.h"

namespace neuvv::xr {

struct XrSwapchainShape {
    VkExtent2D size{};
    uint32_t layers = 1;  // of each image: one an eye
    XrSwapchainUsageFlags usage = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    std::vector<VkFormat> formats;  // that will do
};

// Of the first format in the runtime's order of preference that will do; where the runtime refuses one that it named,
// the next.
class XrImages {
  public:
    // Throws RuntimeFailure where none of the formats is to be had.
    XrImages(const Session& session, const gpu::Device& device, std::string name, const XrSwapchainShape& shape);
    ~XrImages();
    XrImages(const XrImages&) = delete;
    XrImages& operator=(const XrImages&) = delete;

    VkFormat format() const { return format_; }
    VkExtent2D size() const { return shape_.size; }
    XrSwapchain handle() const { return swapchain_.get(); }
    uint32_t count() const { return static_cast<uint32_t>(images_.size()); }

    // The next image that may be drawn into, which may take until the compositor has done with it.
    uint32_t acquire();
    // After its drawing was submitted.
    void release();
    VkImage image(uint32_t index) const { return images_[index]; }
    VkImageView view(uint32_t index) const { return views_[index]; }  // of all its layers
    XrSwapchainSubImage part(uint32_t layer) const;

  private:
    bool create(const Session& session, VkFormat format);
    const gpu::Device& device_;
    std::string name_;
    XrSwapchainShape shape_;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    XrOwnedSwapchain swapchain_;
    std::vector<VkImage> images_;
    std::vector<VkImageView> views_;
};

}  // namespace neuvv::xr
