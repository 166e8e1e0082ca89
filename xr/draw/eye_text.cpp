#include "xr/draw/eye_text.h"

#include <algorithm>

#include "spirv/eye_text.frag.h"
#include "spirv/eye_text.vert.h"
#include "xr/session.h"

namespace neuvv::xr {

namespace {

gpu::GraphicsShape shape_of(VkFormat colour, VkFormat depth) {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = eye_text_vert;
    shape.fragment_spirv = eye_text_frag;
    shape.streams = {{0, sizeof(TextVertex), VK_VERTEX_INPUT_RATE_VERTEX}};
    shape.attributes = {{kTextPosition, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(TextVertex, position)},
                        {kTextColour, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(TextVertex, colour)},
                        {kTextUv, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(TextVertex, uv)}};
    shape.colours = {colour};
    shape.depth = depth;
    shape.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;  // letters lie on their plate
    return shape;
}

}  // namespace

EyeText::EyeText(const gpu::Device& device, VkFormat colour, VkFormat depth)
    : pass_(device, "eye text", shape_of(colour, depth)),
      sampler_(device, "font",
               {VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_FILTER_LINEAR,
                VK_FILTER_LINEAR, false}) {
    for (gpu::Buffer& vertices : vertices_)
        vertices = gpu::Buffer(device, "eye text", kTextCorners * kMaxTextRectangles * sizeof(TextVertex),
                               gpu::MemoryKind::kUpload);
}

void EyeText::set_font(const gpu::DeviceImage& image) {
    const std::pair<const gpu::DeviceImage*, const gpu::Sampler*> texture{&image, &sampler_};
    bound_.emplace(pass_, std::span(&texture, 1));
}

void EyeText::draw(gpu::Commands& commands, std::span<const TextVertex> text, std::span<const ShapePush> pairs) {
    if (!bound_ || text.empty()) return;
    std::rotate(vertices_.begin(), vertices_.begin() + 1, vertices_.end());
    std::copy(text.begin(), text.end(), vertices_[0].as<TextVertex>());
    const VkDeviceSize start = 0;
    const VkDescriptorSet set = bound_->handle();
    vkCmdBindVertexBuffers(commands.handle(), 0, 1, &vertices_[0].buffer, &start);
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.pipeline());
    vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.layout(), 0, 1, &set, 0, nullptr);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_FALSE);
    for (uint32_t pair = 0; pair < pairs.size(); ++pair) {
        vkCmdPushConstants(commands.handle(), pass_.layout(), gpu::kDrawStages, 0, pass_.interface().push_bytes,
                           &pairs[pair]);
        vkCmdDraw(commands.handle(), static_cast<uint32_t>(text.size()), kEyes, 0, pair * kEyes);
    }
}

}  // namespace neuvv::xr
