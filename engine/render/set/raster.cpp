#include "render/set/raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "spirv/raster.frag.h"
#include "spirv/raster.vert.h"

namespace neuvv::render {

namespace {

constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;
constexpr VkFormat kImageFormat = VK_FORMAT_R16G16B16A16_SFLOAT, kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr float kSkyShare = 0.4f;  // soft enough that all sides of a lit object stay visible

gpu::GraphicsShape pass_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = raster_vert;
    shape.fragment_spirv = raster_frag;
    describe_streams(SceneDetail::kBase, shape);
    shape.colours = {kImageFormat};
    shape.depth = kDepthFormat;
    shape.samples = kSamples;
    return shape;
}

}  // namespace

Rasterizer::Rasterizer(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height)
    : device_(device),
      scene_(scene),
      width_(width * kSupersample),
      height_(height * kSupersample),
      pass_(device, "raster", pass_shape()),
      geometry_(device, scene, SceneDetail::kBase),
      commands_(device, "raster") {
    constexpr VkImageUsageFlags kTransient = VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
    samples_ =
        gpu::DeviceImage(device, "raster samples",
                         {width_, height_, kImageFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | kTransient, kSamples});
    depth_ = gpu::DeviceImage(
        device, "raster depth",
        {width_, height_, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | kTransient, kSamples});
    target_ = gpu::DeviceImage(
        device, "raster target",
        {width_, height_, kImageFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    readback_ = gpu::Buffer(device, "raster readback", uint64_t{8} * width_ * height_, gpu::MemoryKind::kReadback);
    upload_textures();
}

void Rasterizer::upload_textures() {
    textures_ = make_textures(device_);
    for (const SceneDraw& draw : geometry_.draws)
        texture_of_draw_.push_back(
            add_texture(device_, scene_, textures_, material_at(scene_, draw.material).texture, true));
    for (const SceneTextures::Entry& entry : textures_.entries) {
        const std::pair<const gpu::DeviceImage*, const gpu::Sampler*> texture{&entry.image, &entry.sampler};
        sets_.emplace_back(pass_, std::span(&texture, 1));
    }
}

void Rasterizer::pose(const stage::PosedScene& pose) {
    pose_geometry(geometry_, pose);
}

RasterImage Rasterizer::draw(const stage::Camera& camera, double near_m) {
    assert(camera.width * kSupersample == width_ && camera.height * kSupersample == height_ && "the image size");
    const glm::dmat4 projection = clip_from_world(camera, near_m);
    const VkRect2D part = visible_part(projection);
    record(glm::mat4(projection), part);
    commands_.submit();
    commands_.wait();
    return {static_cast<uint32_t>(part.offset.x) / kSupersample,
            static_cast<uint32_t>(part.offset.y) / kSupersample,
            part.extent.width / kSupersample,
            part.extent.height / kSupersample,
            {readback_.as<const uint16_t>(), size_t{4} * part.extent.width * part.extent.height}};
}

// The rectangle of the target that the box of the posed scene covers, made of whole pixels of the camera, at least one.
VkRect2D Rasterizer::visible_part(const glm::dmat4& clip_from_world) const {
    const glm::dvec2 size(width_ / kSupersample, height_ / kSupersample);
    glm::dvec2 low = size, high(0);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? geometry_.high.x : geometry_.low.x,
                               corner & 2 ? geometry_.high.y : geometry_.low.y,
                               corner & 4 ? geometry_.high.z : geometry_.low.z);
        const glm::dvec4 clip = clip_from_world * glm::dvec4(point, 1);
        const bool in_front = clip.w > clip.z && std::isfinite(clip.w);  // behind the near plane, seen from the camera
        if (!in_front) return {{0, 0}, {width_, height_}};
        const glm::dvec2 pixel = (0.5 + 0.5 * glm::dvec2(clip) / clip.w) * size;
        low = glm::min(low, pixel - 1.0);
        high = glm::max(high, pixel + 1.0);
    }
    low = glm::clamp(glm::floor(low), glm::dvec2(0), size - 1.0);
    high = glm::clamp(glm::ceil(high), low + 1.0, size);
    const glm::uvec2 from = glm::uvec2(low) * kSupersample, extent = glm::uvec2(high - low) * kSupersample;
    return {{static_cast<int32_t>(from.x), static_cast<int32_t>(from.y)}, {extent.x, extent.y}};
}

void Rasterizer::record(const glm::mat4& clip_from_world, const VkRect2D& part) {
    commands_.begin();
    {
        const gpu::PassScope scope(commands_, "raster");
        for (const gpu::DeviceImage* colour : {&samples_, &target_})
            gpu::move_layout(commands_, *colour, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        gpu::move_layout(commands_, depth_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        begin_rendering(part);
        record_draws(clip_from_world, false);
        record_draws(clip_from_world, true);
        vkCmdEndRendering(commands_.handle());
    }
    gpu::move_layout(commands_, target_, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    gpu::copy(commands_, target_, part, readback_);
    gpu::host_barrier(commands_);
}

void Rasterizer::begin_rendering(const VkRect2D& part) {
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = samples_.view;
    colour.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
    colour.resolveImageView = target_.view;
    colour.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    depth.imageView = depth_.view;
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;  // to 0: infinitely far
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea = part;
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    info.pDepthAttachment = &depth;
    vkCmdBeginRendering(commands_.handle(), &info);
    const VkViewport viewport{0, 0, static_cast<float>(width_), static_cast<float>(height_), 0, 1};
    vkCmdBindPipeline(commands_.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.pipeline());
    vkCmdSetViewport(commands_.handle(), 0, 1, &viewport);
    vkCmdSetScissor(commands_.handle(), 0, 1, &part);
    bind_streams(commands_, geometry_);
}

// Blended materials are drawn after all others and do not write depth. They are drawn in the file's order.
void Rasterizer::record_draws(const glm::mat4& clip_from_world, bool blended) {
    VkCommandBuffer to = commands_.handle();
    for (size_t i = 0; i < geometry_.draws.size(); ++i) {
        const SceneDraw& draw = geometry_.draws[i];
        const stage::GltfMaterial& material = material_at(scene_, draw.material);
        if ((material.alpha == stage::GltfAlpha::kBlend) != blended) continue;
        RasterPush push{};
        push.clip_from_world = clip_from_world;
        push.base_colour = material.base_color;
        push.alpha_cutoff = material.alpha == stage::GltfAlpha::kMask ? material.alpha_cutoff : -1;
        push.opaque = blended ? 0 : 1;
        push.sky = material.unlit ? 0 : kSkyShare;
        const VkDescriptorSet set = sets_[texture_of_draw_[i]].handle();
        vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.layout(), 0, 1, &set, 0, nullptr);
        vkCmdPushConstants(to, pass_.layout(), gpu::kDrawStages, 0, sizeof(push), &push);
        vkCmdSetCullMode(to, material.double_sided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
        vkCmdSetFrontFace(to, draw.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
        vkCmdSetDepthWriteEnable(to, !blended);
        vkCmdDrawIndexed(to, static_cast<uint32_t>(draw.primitive->indices.size()), 1, draw.first_index,
                         static_cast<int32_t>(draw.first_vertex), 0);
    }
}

glm::dmat4 clip_from_world(const stage::Camera& camera, double near_m) {
    // x_px = cx − fx·x/z and y_px = cy + fy·y/z with z < 0 in front; clip w = −z, and NDC = 2·px/size − 1.
    const double w = camera.width, h = camera.height;
    glm::dmat4 clip(0);
    clip[0][0] = 2 * camera.fx / w;
    clip[2][0] = 1 - 2 * camera.cx / w;
    clip[1][1] = -2 * camera.fy / h;
    clip[2][1] = 1 - 2 * camera.cy / h;
    clip[3][2] = near_m;
    clip[2][3] = -1;
    return clip * glm::inverse(camera.world_from_camera);
}

}  // namespace neuvv::render
