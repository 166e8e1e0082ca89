// Swapchains of OpenXR: images for the headset, which are acquired, drawn to, and released to the compositor.
#pragma once

#include <string>
#include <vector>

#include "gpu/image.h"
#include "xr/session.h"

namespace neuvv::xr {

struct SwapchainShape {
    VkExtent2D size{};
    uint32_t layers = 1;  // of each image; one for each view
    XrSwapchainUsageFlags usage = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    std::vector<VkFormat> formats;  // those that the program can draw, in any order
};

// The images of a swapchain. Their format is the first one in the runtime's order of preference that is in
// SwapchainShape::formats; a format that the runtime offers and yet refuses is skipped.
class SwapchainImages {
  public:
    // `name` appears in messages. Throws RuntimeFailure where the runtime has none of the formats.
    SwapchainImages(const Session& session, const gpu::Device& device, std::string name, const SwapchainShape& shape);
    ~SwapchainImages();
    SwapchainImages(const SwapchainImages&) = delete;
    SwapchainImages& operator=(const SwapchainImages&) = delete;

    VkFormat format() const { return format_; }
    VkExtent2D size() const { return shape_.size; }
    XrSwapchain handle() const { return swapchain_.get(); }
    uint32_t count() const { return static_cast<uint32_t>(images_.size()); }

    // Returns the index of the next image to draw to; waits until the compositor no longer uses it.
    uint32_t acquire();
    // Gives the acquired image to the compositor. The work that draws it must have been submitted before.
    void release();
    VkImage image(uint32_t index) const { return images_[index]; }
    VkImageView view(uint32_t index) const { return views_[index]; }  // of all layers of the image
    // One layer of the swapchain's images for a composition layer: whole, or the upper left part of this size.
    XrSwapchainSubImage sub_image(uint32_t layer) const { return sub_image(layer, shape_.size); }
    XrSwapchainSubImage sub_image(uint32_t layer, VkExtent2D part) const;

  private:
    bool create(const Session& session, VkFormat format);
    const gpu::Device& device_;
    std::string name_;
    SwapchainShape shape_;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    XrOwnedSwapchain swapchain_;
    std::vector<VkImage> images_;
    std::vector<VkImageView> views_;
};

}  // namespace neuvv::xr
