#include "render/set/hidden_parts.h"

#include <cstring>

#include "gpu/commands.h"
#include "render/set/set_targets.h"
#include "spirv/set_hidden.frag.h"
#include "spirv/set_hidden.vert.h"

namespace neuvv::render {

namespace {

gpu::GraphicsShape hidden_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_hidden_vert;
    shape.fragment_spirv = set_hidden_frag;
    shape.streams = {{0, sizeof(glm::vec2), VK_VERTEX_INPUT_RATE_VERTEX}};
    shape.attributes = {{0, 0, VK_FORMAT_R32G32_SFLOAT, 0}};
    shape.colours = {kSetColour, kSetMetres};
    shape.blend = false;
    return shape;
}

}  // namespace

void HiddenParts::set(const gpu::Device& device, std::span<const std::vector<glm::vec2>> corners) {
    std::vector<glm::vec2> all;
    std::vector<std::pair<uint32_t, uint32_t>> of_view;
    for (const auto& list : corners) {
        of_view.emplace_back(all.size(), list.size());
        all.insert(all.end(), list.begin(), list.end());
    }
    if (!pass_ && all.empty()) return;
    if (!pass_) pass_ = std::make_unique<gpu::GraphicsPass>(device, "set hidden", hidden_shape());
    of_view_ = std::move(of_view);
    const uint64_t bytes = all.size() * sizeof(glm::vec2);
    if (bytes > corners_.bytes) corners_ = gpu::Buffer(device, "hidden corners", bytes, gpu::MemoryKind::kUpload);
    if (bytes > 0) std::memcpy(corners_.mapped, all.data(), bytes);
}

void HiddenParts::draw(gpu::Commands& commands, uint32_t view) const {
    if (of_view_.empty()) return;
    const auto [first, count] = of_view_[view];
    if (count == 0) return;
    VkCommandBuffer to = commands.handle();
    const VkDeviceSize start = 0;
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_->pipeline());
    vkCmdBindVertexBuffers(to, 0, 1, &corners_.buffer, &start);
    vkCmdSetCullMode(to, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(to, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(to, VK_TRUE);
    vkCmdDraw(to, count, 1, first, 0);
}

}  // namespace neuvv::render
