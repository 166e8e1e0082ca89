// The part of SetRaster that records commands.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tuple>

#include "render/set/raster.h"
#include "render/set/set_raster.h"

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

VkRenderingAttachmentInfo colour_attachment(const gpu::DeviceImage& image, bool keep, float red = 0) {
    VkClearValue clear{};
    clear.color.float32[0] = red;
    return attachment(image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, keep, clear);
}

// Depth is cleared to 0: infinitely far.
VkRenderingAttachmentInfo depth_attachment(const gpu::DeviceImage& image, bool keep) {
    return attachment(image, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, keep);
}

VkRect2D area_of(const stage::Camera& camera) {
    return {{0, 0}, {camera.width, camera.height}};
}

void begin(gpu::Commands& commands, std::span<const VkRenderingAttachmentInfo> colours,
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

void to_attachment(gpu::Commands& commands, const gpu::DeviceImage& image,
                   VkImageLayout from = VK_IMAGE_LAYOUT_UNDEFINED) {
    gpu::move_layout(commands, image, from,
                     image.shape.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL
                                                                : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
}

// Copies a part of an attachment that was drawn to, as the image number `index` of that size, to the buffer. The
// attachment is left in layout TRANSFER_SRC.
void store(gpu::Commands& commands, const gpu::DeviceImage& image, const VkRect2D& area, const gpu::Buffer& to,
           uint32_t index) {
    const bool depth = image.shape.format == VK_FORMAT_D32_SFLOAT;
    gpu::move_layout(commands, image,
                     depth ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const uint64_t bytes = image.shape.format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
    gpu::copy(commands, image, area, to, bytes * index * area.extent.width * area.extent.height);
}

}  // namespace

void SetRaster::record_lights(gpu::Commands& commands) const {
    gpu::update(commands, lights_buffer, packed_);
    gpu::compute_barrier(commands);
}

void SetRaster::record_shadows(gpu::Commands& commands) {
    if (!shadows_outdated_ || catcher_floor_m_) return;
    shadows_outdated_ = false;
    for (uint32_t i = 0; i < packed_.count; ++i)
        if (packed_.light[i].shadow != kNoShadow) record_shadow(commands, packed_.light[i]);
    gpu::compute_barrier(commands);
}

void SetRaster::record_solid(gpu::Commands& commands, std::span<const stage::Camera> cameras) {
    assert(cameras.size() <= views() && "one camera a view");
    gpu::draw_barrier(commands);
    for (uint32_t view = 0; view < cameras.size(); ++view) record_view(commands, cameras[view], view);
    gpu::compute_barrier(commands);
}

void SetRaster::record_transparent(gpu::Commands& commands, std::span<const stage::Camera> cameras) {
    if (!has_transparent()) return;
    assert(cameras.size() <= views() && "one camera a view");
    gpu::draw_barrier(commands);
    for (uint32_t view = 0; view < cameras.size(); ++view) record_blended_view(commands, cameras[view], view);
    gpu::compute_barrier(commands);
}

void SetRaster::record_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view) {
    const gpu::PassScope scope(commands, "set");
    for (const gpu::DeviceImage* image : {&colours_[view], &metres_, &depths_[view]}) to_attachment(commands, *image);
    const std::array targets{colour_attachment(colours_[view], false), colour_attachment(metres_, false, INFINITY)};
    begin(commands, targets, depth_attachment(depths_[view], false), area_of(camera));
    if (hidden_ && !hidden_->of_view.empty()) draw_hidden(commands, view);
    if (catcher_floor_m_) {
        draw_catcher(commands, push_of(camera, view));
    } else {
        draw_solid(commands, push_of(camera, view));
        if (environment_->has_image && ambient_.show_environment) draw_background(commands, camera);
    }
    vkCmdEndRendering(commands.handle());
    store(commands, colours_[view], area_of(camera), colour, view);
    store(commands, metres_, area_of(camera), depth, view);
}

void SetRaster::record_blended_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view) {
    const gpu::PassScope scope(commands, "set transparent");
    to_attachment(commands, colours_[view], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    to_attachment(commands, front_);
    to_attachment(commands, depths_[view], VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    const std::array targets{colour_attachment(colours_[view], true), colour_attachment(front_, false)};
    begin(commands, targets, depth_attachment(depths_[view], true), area_of(camera));
    draw_blended(commands, push_of(camera, view));
    vkCmdEndRendering(commands.handle());
    store(commands, colours_[view], area_of(camera), colour, view);
    store(commands, front_, area_of(camera), front, view);
}

void SetRaster::record_shadow(gpu::Commands& commands, const ShaderLight& light) {
    const gpu::PassScope scope(commands, "set shadow");
    to_attachment(commands, shadow_depth_);
    constexpr VkRect2D kWhole{{0, 0}, {kSetShadowSide, kSetShadowSide}};
    begin(commands, {}, depth_attachment(shadow_depth_, false), kWhole);
    SetPush push{};
    push.clip_from_world = light.clip_from_world;
    draw_shadowing(commands, push);
    vkCmdEndRendering(commands.handle());
    store(commands, shadow_depth_, kWhole, set_shadow_maps, light.shadow);
}

SetPush SetRaster::push_of(const stage::Camera& camera, uint32_t view) const {
    assert(camera.width <= width_ && camera.height <= height_ && "the size of the set's images");
    SetPush push{};
    push.clip_from_world = glm::mat4(clip_from_world(camera, kSetNear_m));
    push.eye = glm::vec4(camera.world_from_camera[3]);
    push.first_texel = view * camera.width * camera.height;
    push.width = camera.width;
    return push;
}

void SetRaster::draw_background(gpu::Commands& commands, const stage::Camera& camera) const {
    SetPush push{};
    push.clip_from_world = glm::mat4(glm::inverse(clip_from_world(camera, kSetNear_m)));
    VkCommandBuffer to = commands.handle();
    const VkDescriptorSet set = surfaces_.background.handle();
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, background_.pipeline());
    vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, background_.layout(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(to, background_.layout(), gpu::kDrawStages, 0, background_.interface().push_bytes, &push);
    vkCmdSetCullMode(to, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(to, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(to, VK_FALSE);
    vkCmdDraw(to, 3, 1, 0, 0);
}

void SetRaster::draw_catcher(gpu::Commands& commands, SetPush push) const {
    push.eye.y = static_cast<float>(*catcher_floor_m_);
    VkCommandBuffer to = commands.handle();
    const gpu::GraphicsPass& pass = catcher_->pass;
    const VkDescriptorSet set = catcher_->bound.handle();
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.pipeline());
    vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.layout(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(to, pass.layout(), gpu::kDrawStages, 0, pass.interface().push_bytes, &push);
    vkCmdSetCullMode(to, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(to, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(to, VK_TRUE);
    vkCmdDraw(to, 3, 1, 0, 0);
}

// Draws the hidden triangles nearer than everything else, so that nothing else is drawn there.
void SetRaster::draw_hidden(gpu::Commands& commands, uint32_t view) const {
    const auto [first, count] = hidden_->of_view[view];
    if (count == 0) return;
    VkCommandBuffer to = commands.handle();
    const VkDeviceSize start = 0;
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, hidden_->pass.pipeline());
    vkCmdBindVertexBuffers(to, 0, 1, &hidden_->corners.buffer, &start);
    vkCmdSetCullMode(to, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(to, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(to, VK_TRUE);
    vkCmdDraw(to, count, 1, first, 0);
}

// Sorts by the centres of the primitives' boxes, and by the file's order at equal distances.
void SetRaster::sort_far_to_near(const glm::vec3& eye) {
    order_.clear();
    for (uint32_t i = 0; i < geometry_.draws.size(); ++i) {
        const SceneDraw& one = geometry_.draws[i];
        const float distance = glm::length(0.5f * (one.low + one.high) - eye);
        order_.emplace_back(std::isfinite(distance) ? -distance : 0, i);  // not finite where vertices overflow
    }
    std::sort(order_.begin(), order_.end());
}

// Draws near to far, so that few hidden fragments are shaded; masked pieces come last.
void SetRaster::draw_solid(gpu::Commands& commands, const SetPush& push) {
    sort_far_to_near(glm::vec3(push.eye));
    bind_streams(commands, geometry_);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_TRUE);
    for (const auto& [alpha, pass, sets] : {std::tuple{stage::GltfAlpha::kOpaque, &solid_, &surfaces_.solid},
                                            std::tuple{stage::GltfAlpha::kMask, &masked_, &surfaces_.masked}}) {
        vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pass->pipeline());
        for (auto next = order_.rbegin(); next != order_.rend(); ++next) {
            const SceneDraw& one = geometry_.draws[next->second];
            if (material_at(*scene_, one.material).alpha == alpha) draw(commands, *pass, *sets, one, push);
        }
    }
}

void SetRaster::draw_blended(gpu::Commands& commands, const SetPush& push) {
    sort_far_to_near(glm::vec3(push.eye));
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, blended_.pipeline());
    bind_streams(commands, geometry_);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_FALSE);
    for (const auto& [nearness, i] : order_) {
        const SceneDraw& one = geometry_.draws[i];
        if (material_at(*scene_, one.material).alpha == stage::GltfAlpha::kBlend)
            draw(commands, blended_, surfaces_.blended, one, push);
    }
}

void SetRaster::draw_shadowing(gpu::Commands& commands, const SetPush& push) const {
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, shadow_.pipeline());
    bind_streams(commands, geometry_);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_TRUE);
    for (const SceneDraw& one : geometry_.draws)
        if (material_at(*scene_, one.material).alpha != stage::GltfAlpha::kBlend)
            draw(commands, shadow_, surfaces_.shadow, one, push);
}

void SetRaster::draw(gpu::Commands& commands, const gpu::GraphicsPass& pass, const std::vector<gpu::TextureSet>& sets,
                     const SceneDraw& draw, SetPush push) const {
    VkCommandBuffer to = commands.handle();
    const bool both_sides = material_at(*scene_, draw.material).double_sided || &pass == &shadow_;
    push.material = static_cast<uint32_t>(draw.material + 1);
    const VkDescriptorSet set = sets[push.material].handle();
    vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.layout(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(to, pass.layout(), gpu::kDrawStages, 0, pass.interface().push_bytes, &push);
    vkCmdSetCullMode(to, both_sides ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
    vkCmdSetFrontFace(to, draw.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdDrawIndexed(to, static_cast<uint32_t>(draw.primitive->indices.size()), 1, draw.first_index,
                     static_cast<int32_t>(draw.first_vertex), 0);
}

}  // namespace neuvv::render
