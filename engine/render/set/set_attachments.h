// The images that the raster passes of a set draw to: how drawing begins, and how they reach the buffers that other
// passes read.
#pragma once

#include <span>

#include "gpu/commands.h"
#include "gpu/image.h"

namespace neuvv::render {

// `keep`: what was drawn stays; else the image is cleared.
VkRenderingAttachmentInfo colour_attachment(const gpu::DeviceImage& image, bool keep, float red = 0);
// Depth is cleared to 0: infinitely far.
VkRenderingAttachmentInfo depth_attachment(const gpu::DeviceImage& image, bool keep);

void to_attachment(gpu::Commands& commands, const gpu::DeviceImage& image,
                   VkImageLayout from = VK_IMAGE_LAYOUT_UNDEFINED);
// Draws go to this area of the attachments, until vkCmdEndRendering.
void begin_drawing(gpu::Commands& commands, std::span<const VkRenderingAttachmentInfo> colours,
                   const VkRenderingAttachmentInfo& depth, const VkRect2D& area);
// Copies a part of an attachment that was drawn to, as the image number `index` of that size, to the buffer. The
// attachment is left in layout TRANSFER_SRC.
void store(gpu::Commands& commands, const gpu::DeviceImage& image, const VkRect2D& area, const gpu::Buffer& to,
           uint32_t index);

}  // namespace neuvv::render
