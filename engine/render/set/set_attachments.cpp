#include "render/set/set_attachments.h"

namespace neuvv::render {

namespace {

VkRenderingAttachmentInfo attachment(const gpu::DeviceImage& image, VkImageLayout layout, bool keep,
                                     const VkClearValue& clear = {}) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = image.view;
    info.imageLayout = layout;
    info.loadOp = keep ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = clear;
    return info;
}

}  // namespace

VkRenderingAttachmentInfo colour_attachment(const gpu::DeviceImage& image, bool keep, float red) {
    VkClearValue clear{};
    clear.color.float32[0] = red;
    return attachment(image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, keep, clear);
}

VkRenderingAttachmentInfo depth_attachment(const gpu::DeviceImage& image, bool keep) {
    return attachment(image, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, keep);
}

void to_attachment(gpu::Commands& commands, const gpu::DeviceImage& image, VkImageLayout from) {
    gpu::move_layout(commands, image, from,
                     image.shape.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL
                                                                : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
}

void begin_drawing(gpu::Commands& commands, std::span<const VkRenderingAttachmentInfo> colours,
                   const VkRenderingAttachmentInfo& depth, const VkRect2D& area) {
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea = area;
    info.layerCount = 1;
    info.colorAttachmentCount = static_cast<uint32_t>(colours.size());
    info.pColorAttachments = colours.data();
    info.pDepthAttachment = &depth;
    vkCmdBeginRendering(commands.handle(), &info);
    const VkViewport viewport{0, 0, static_cast<float>(area.extent.width), static_cast<float>(area.extent.height),
                              0, 1};
    vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
    vkCmdSetScissor(commands.handle(), 0, 1, &area);
}

void store(gpu::Commands& commands, const gpu::DeviceImage& image, const VkRect2D& area, const gpu::Buffer& to,
           uint32_t index) {
    const bool depth = image.shape.format == VK_FORMAT_D32_SFLOAT;
    gpu::move_layout(commands, image,
                     depth ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const uint64_t bytes = image.shape.format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
    gpu::copy(commands, image, area, to, bytes * index * area.extent.width * area.extent.height);
}

}  // namespace neuvv::render
