#include "tools/headset/mirror.h"

#include <algorithm>

namespace neuvv::headset {

Mirror::Mirror(const gpu::Device& device, ui::Window& window, VkExtent2D eye)
    : device_(device),
      window_(window),
      swapchain_(device, window.make_surface(device), gpu::PresentPace::kFree),  // only the headset throttles the loop
      values_(device, "mirror",
              {eye.width, eye.height, VK_FORMAT_R8G8B8A8_UNORM,
               VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT}),
      commands_(device, "mirror", 4) {
    swapchain_.resize(window.framebuffer());
}

bool Mirror::show(const gpu::DeviceImage* image) {
    window_.poll();
    if (window_.close_requested()) return false;
    if (!image) return true;
    const VkExtent2D framebuffer = window_.framebuffer(), extent = swapchain_.extent();
    if (framebuffer.width == 0 || framebuffer.height == 0) return true;  // minimised
    if (!commands_.is_done()) return true;  // the monitor is slower than the headset: leave this image out
    commands_.wait();
    if (swapchain_.is_outdated() || framebuffer.width != extent.width || framebuffer.height != extent.height)
        swapchain_.resize(framebuffer);
    gpu::CommandSemaphores semaphores;
    const std::optional<gpu::PresentTarget> target = swapchain_.acquire(semaphores);
    if (!target) return true;
    commands_.begin();
    record(*image, *target);
    commands_.submit(semaphores);
    swapchain_.present(*target);
    return true;
}

void Mirror::record(const gpu::DeviceImage& image, const gpu::PresentTarget& target) {
    gpu::move_layout(commands_, values_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkImageCopy part{};
    part.srcSubresource = part.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    part.extent = {values_.shape.width, values_.shape.height, 1};
    vkCmdCopyImage(commands_.handle(), image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, values_.image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &part);
    gpu::move_layout(commands_, values_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);

    gpu::move_layout(commands_, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkClearColorValue black{};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands_.handle(), target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &all);
    gpu::full_barrier(commands_);
    const double fits = std::min(static_cast<double>(target.extent.width) / values_.shape.width,
                                 static_cast<double>(target.extent.height) / values_.shape.height);
    const auto width = static_cast<int32_t>(values_.shape.width * fits),
               height = static_cast<int32_t>(values_.shape.height * fits);
    const VkOffset3D first{(static_cast<int32_t>(target.extent.width) - width) / 2,
                           (static_cast<int32_t>(target.extent.height) - height) / 2, 0};
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    blit.srcOffsets[1] = {static_cast<int32_t>(values_.shape.width), static_cast<int32_t>(values_.shape.height), 1};
    blit.dstOffsets[0] = first;
    blit.dstOffsets[1] = {first.x + width, first.y + height, 1};
    vkCmdBlitImage(commands_.handle(), values_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
    gpu::move_layout(commands_, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

}  // namespace neuvv::headset
