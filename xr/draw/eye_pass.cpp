#include "xr/draw/eye_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "render/set/raster.h"
#include "shared/eye.h"
#include "spirv/eye.frag.h"
#include "spirv/eye.vert.h"
#include "spirv/eye_shape.frag.h"
#include "spirv/eye_shape.vert.h"

namespace neuvv::xr {

namespace {

constexpr uint64_t kFirstVertices = 1 << 14;

const gpu::Device& require_output_layer(const gpu::Device& device) {
    if (device.output_layer()) return device;
    throw RuntimeFailure(
        fmt::format("device \"{}\" cannot draw both eyes at once: it lacks shaderOutputLayer", device.summary().name));
}

gpu::GraphicsShape image_shape(const gpu::Device& device, VkFormat colour, VkFormat depth) {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = eye_vert;
    shape.fragment_spirv = device.buffers().fitting(eye_frag, eye_frag_storage);
    shape.colours = {colour};
    shape.blend = false;
    shape.depth = depth;
    shape.depth_compare = VK_COMPARE_OP_ALWAYS;
    return shape;
}

gpu::GraphicsShape shape_of(const gpu::Device& device, VkFormat colour, VkFormat depth, bool blend,
                            VkCompareOp nearer = VK_COMPARE_OP_GREATER) {
    gpu::GraphicsShape shape = image_shape(device, colour, depth);
    shape.vertex_spirv = eye_shape_vert;
    shape.fragment_spirv = eye_shape_frag;
    shape.streams = {{0, sizeof(ShapeVertex), VK_VERTEX_INPUT_RATE_VERTEX}};
    shape.attributes = {{kShapePosition, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(ShapeVertex, position)},
                        {kShapeColour, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(ShapeVertex, colour)}};
    shape.blend = blend;
    shape.depth_compare = nearer;
    return shape;
}

VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = view;
    info.imageLayout = layout;
    info.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;  // the first draw covers the whole image
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    return info;
}

template <typename Push>
void push(gpu::Commands& commands, const gpu::GraphicsPass& pass, const Push& values) {
    vkCmdPushConstants(commands.handle(), pass.layout(), gpu::kDrawStages, 0, pass.interface().push_bytes, &values);
}

}  // namespace

const std::vector<VkFormat>& eye_colour_formats() {
    static const std::vector<VkFormat> kFormats{VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB};
    return kFormats;
}

const std::vector<VkFormat>& eye_depth_formats() {
    static const std::vector<VkFormat> kFormats{VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM};
    return kFormats;
}

EyePass::EyePass(const gpu::Device& device, VkFormat colour, VkFormat depth)
    : device_(require_output_layer(device)),
      image_(device, "eye", image_shape(device, colour, depth)),
      solid_(device, "eye shape", shape_of(device, colour, depth, false)),
      translucent_(device, "eye translucent shape", shape_of(device, colour, depth, true)),
      on_top_(device, "eye on-top shape", shape_of(device, colour, depth, true, VK_COMPARE_OP_ALWAYS)),
      text_(device, colour, depth) {
    for (gpu::Buffer& vertices : vertices_)
        vertices = gpu::Buffer(device, "eye shapes", kFirstVertices * sizeof(ShapeVertex), gpu::MemoryKind::kUpload);
}

void EyePass::bind(const render::StageRenderer& renderer, const gpu::Buffer& images) {
    const std::array<VkBuffer, 2> to{images.buffer, renderer.set().targets().depth.buffer};
    if (to == bound_to_) return;
    const render::RayBatch& rays = renderer.frames().target().rays;
    bound_ = gpu::TextureSet(image_, {},
                             {{kEyeImage, &images},
                              {kEyeRadiance, &rays.radiance},
                              {kEyeDepth, &rays.depth},
                              {kEyeCameras, &rays.cameras},
                              {kEyeSetDepth, &renderer.set().targets().depth}});
    bound_to_ = to;
}

void EyePass::upload(const EyeShapes& shapes) {
    const std::array lists{shapes.on_top(), shapes.holes(), shapes.solid(), shapes.solid_on_top(),
                           shapes.translucent()};
    uint64_t count = 0;
    for (const auto list : lists) count += list.size();
    std::rotate(vertices_.begin(), vertices_.begin() + 1, vertices_.end());
    gpu::Buffer& vertices = vertices_[0];
    if (count * sizeof(ShapeVertex) > vertices.bytes)
        vertices = gpu::Buffer(device_, "eye shapes", 2 * count * sizeof(ShapeVertex), gpu::MemoryKind::kUpload);
    auto* to = vertices.as<ShapeVertex>();
    for (const auto list : lists) to = std::copy(list.begin(), list.end(), to);
}

void EyePass::record(gpu::Commands& commands, const render::StageRenderer& renderer, const gpu::Buffer& images,
                     std::span<const stage::Camera> cameras, const EyeShapes& shapes, const EyeShade& shade,
                     const EyeTarget& target) {
    bind(renderer, images);
    upload(shapes);
    const gpu::PassScope scope(commands, "eyes");
    gpu::draw_barrier(commands);
    const auto views = static_cast<uint32_t>(cameras.size());
    const VkImageSubresourceRange all_colour{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, views},
        all_depth{VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, views};
    constexpr VkImageLayout kColourLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                            kDepthLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    // OpenXR hands images out in these layouts and expects them back in the same ones; their old content is not needed.
    gpu::move_layout(commands, target.colour, all_colour, VK_IMAGE_LAYOUT_UNDEFINED, kColourLayout);
    gpu::move_layout(commands, target.depth, all_depth, VK_IMAGE_LAYOUT_UNDEFINED, kDepthLayout);
    const VkRenderingAttachmentInfo colour = attachment(target.colour_view, kColourLayout),
                                    depth = attachment(target.depth_view, kDepthLayout);
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = target.size;
    info.layerCount = views;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    info.pDepthAttachment = &depth;
    vkCmdBeginRendering(commands.handle(), &info);
    const VkViewport viewport{0, 0, static_cast<float>(target.size.width), static_cast<float>(target.size.height),
                              0, 1};
    vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
    vkCmdSetScissor(commands.handle(), 0, 1, &info.renderArea);
    vkCmdSetCullMode(commands.handle(), VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(commands.handle(), VK_FRONT_FACE_COUNTER_CLOCKWISE);
    draw_image(commands, renderer.frames().plan().layout, shade);
    draw_shapes(commands, cameras, shapes);
    vkCmdEndRendering(commands.handle());
}

void EyePass::draw_image(gpu::Commands& commands, const render::ViewLayout& layout, const EyeShade& shade) {
    const VkDescriptorSet set = bound_.handle();
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, image_.pipeline());
    vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, image_.layout(), 0, 1, &set, 0,
                            nullptr);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_TRUE);
    push(commands, image_,
         EyePush{layout.width, layout.height, layout.tiles_across(), layout.tiles_down(),
                 static_cast<float>(render::kSetNear_m), static_cast<float>(shade.vignette),
                 static_cast<float>(shade.fade)});
    vkCmdDraw(commands.handle(), 3, layout.views, 0, 0);
}

// Holes and solid shapes are drawn where they are nearer than what is drawn already. Holes write their depth, too, so a
// hand in front of a panel covers it.
void EyePass::draw_shapes(gpu::Commands& commands, std::span<const stage::Camera> cameras, const EyeShapes& shapes) {
    assert(cameras.size() % kEyes == 0);
    std::vector<ShapePush> pairs(cameras.size() / kEyes);
    for (size_t view = 0; view < cameras.size(); ++view)
        pairs[view / kEyes].clip_from_world[view % kEyes] =
            glm::mat4(render::clip_from_world(cameras[view], render::kSetNear_m));
    const VkDeviceSize start = 0;
    vkCmdBindVertexBuffers(commands.handle(), 0, 1, &vertices_[0].buffer, &start);
    uint32_t first = 0;
    const auto draw = [&](const gpu::GraphicsPass& pass, std::span<const ShapeVertex> list, VkBool32 writes_depth) {
        const auto count = static_cast<uint32_t>(list.size());
        if (count > 0) {
            vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pass.pipeline());
            vkCmdSetDepthWriteEnable(commands.handle(), writes_depth);
            for (uint32_t pair = 0; pair < pairs.size(); ++pair) {
                push(commands, pass, pairs[pair]);
                vkCmdDraw(commands.handle(), count, kEyes, first, pair * kEyes);
            }
        }
        first += count;
    };
    draw(on_top_, shapes.on_top(), VK_FALSE);
    draw(solid_, shapes.holes(), VK_TRUE);
    draw(solid_, shapes.solid(), VK_TRUE);
    draw(solid_, shapes.solid_on_top(), VK_TRUE);
    draw(translucent_, shapes.translucent(), VK_FALSE);
    text_.draw(commands, shapes.text(), pairs);
}

}  // namespace neuvv::xr
