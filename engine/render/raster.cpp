#include "render/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "spirv/raster.frag.h"
#include "spirv/raster.vert.h"

namespace neuvv {

namespace {

constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;
constexpr VkFormat kColour = VK_FORMAT_R16G16B16A16_SFLOAT, kDepth = VK_FORMAT_D32_SFLOAT;
constexpr float kSkyShare = 0.4f;  // soft enough that all sides of a lit material stay readable

struct MovingVertex {
    glm::vec3 position, normal;
};
struct FixedVertex {
    glm::vec2 uv;
    glm::vec4 colour;
};

GraphicsShape pass_shape() {
    GraphicsShape shape;
    shape.vertex_spirv = raster_vert;
    shape.fragment_spirv = raster_frag;
    shape.streams = {{0, sizeof(MovingVertex), VK_VERTEX_INPUT_RATE_VERTEX},
                     {1, sizeof(FixedVertex), VK_VERTEX_INPUT_RATE_VERTEX}};
    shape.attributes = {{kRasterPosition, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(MovingVertex, position)},
                        {kRasterNormal, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(MovingVertex, normal)},
                        {kRasterUv, 1, VK_FORMAT_R32G32_SFLOAT, offsetof(FixedVertex, uv)},
                        {kRasterColour, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(FixedVertex, colour)}};
    shape.colour = kColour;
    shape.depth = kDepth;
    shape.samples = kSamples;
    return shape;
}

VkSamplerAddressMode address_mode(GltfWrap wrap) {
    switch (wrap) {
        case GltfWrap::kRepeat:
            return VK_SAMPLER_ADDRESS_MODE_REPEAT;
        case GltfWrap::kMirroredRepeat:
            return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case GltfWrap::kClampToEdge:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    }
    return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

SamplerShape sampler_shape(const GltfTexture& texture) {
    SamplerShape shape;
    shape.wrap_u = address_mode(texture.wrap_u);
    shape.wrap_v = address_mode(texture.wrap_v);
    shape.magnification = texture.nearest_magnification ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    shape.minification = texture.nearest_minification ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    shape.mipmaps = texture.mipmaps;
    return shape;
}

DeviceImage make_texture(const Device& device, const std::string& name, const Image& image) {
    const std::vector<std::vector<uint8_t>> levels = mip_levels(image);
    DeviceImage texture(device, name,
                        {image.width, image.height, VK_FORMAT_R8G8B8A8_SRGB,
                         VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_SAMPLE_COUNT_1_BIT,
                         static_cast<uint32_t>(levels.size())});
    upload_levels(device, texture, levels);
    return texture;
}

const GltfMaterial& material_of(const GltfScene& scene, int32_t index) {
    static const GltfMaterial kDefault;
    return index < 0 ? kDefault : scene.materials[static_cast<size_t>(index)];
}

}  // namespace

Rasterizer::Rasterizer(const Device& device, const GltfScene& scene, uint32_t width, uint32_t height)
    : device_(device),
      scene_(scene),
      width_(width * kSupersample),
      height_(height * kSupersample),
      pass_(device, "raster", pass_shape()),
      commands_(device, "raster") {
    constexpr VkImageUsageFlags kTransient = VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
    samples_ = DeviceImage(device, "raster samples",
                           {width_, height_, kColour, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | kTransient, kSamples});
    depth_ = DeviceImage(device, "raster depth",
                         {width_, height_, kDepth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | kTransient, kSamples});
    target_ =
        DeviceImage(device, "raster target",
                    {width_, height_, kColour, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    readback_ = Buffer(device, "raster readback", uint64_t{8} * width_ * height_, MemoryKind::kReadback);
    list_draws();
    upload_geometry();
    upload_textures();
}

void Rasterizer::list_draws() {
    uint64_t vertices = 0, indices = 0;
    for (uint32_t n = 0; n < scene_.nodes.size(); n++) {
        const GltfNode& node = scene_.nodes[n];
        if (!node.in_scene || node.mesh < 0) continue;
        for (const GltfPrimitive& primitive : scene_.meshes[static_cast<size_t>(node.mesh)].primitives) {
            draws_.push_back({n, &primitive, static_cast<uint32_t>(vertices), static_cast<uint32_t>(indices),
                              primitive.material, false});
            vertices += primitive.positions.size();
            indices += primitive.indices.size();
            if (vertices > INT32_MAX || indices > UINT32_MAX)
                throw RuntimeFailure(scene_.file + ": more vertices than one picture takes; use a smaller model");
        }
    }
    vertex_count_ = static_cast<uint32_t>(vertices);
    index_count_ = static_cast<uint32_t>(indices);
}

void Rasterizer::upload_geometry() {
    std::vector<FixedVertex> fixed;
    std::vector<uint32_t> indices;
    fixed.reserve(vertex_count_);
    indices.reserve(index_count_);
    for (const Draw& draw : draws_) {
        const GltfPrimitive& from = *draw.primitive;
        for (size_t v = 0; v < from.positions.size(); v++)
            fixed.push_back(
                {from.uvs.empty() ? glm::vec2(0) : from.uvs[v], from.colors.empty() ? glm::vec4(1) : from.colors[v]});
        indices.insert(indices.end(), from.indices.begin(), from.indices.end());
    }
    moving_ = Buffer(device_, "raster moving vertices", vertex_count_ * sizeof(MovingVertex), MemoryKind::kUpload);
    fixed_ = Buffer(device_, "raster fixed vertices", fixed.size() * sizeof(FixedVertex), MemoryKind::kUpload);
    indices_ = Buffer(device_, "raster indices", indices.size() * sizeof(uint32_t), MemoryKind::kUpload);
    std::memcpy(moving_.mapped, std::vector<MovingVertex>(vertex_count_).data(), vertex_count_ * sizeof(MovingVertex));
    std::memcpy(fixed_.mapped, fixed.data(), fixed.size() * sizeof(FixedVertex));
    std::memcpy(indices_.mapped, indices.data(), indices.size() * sizeof(uint32_t));
}

void Rasterizer::upload_textures() {
    std::vector<bool> used(scene_.textures.size(), false);
    for (const Draw& draw : draws_)
        if (const int32_t texture = material_of(scene_, draw.material).texture; texture >= 0)
            used[static_cast<size_t>(texture)] = true;
    Image white(1, 1);
    white.rgba.assign(4, 255);
    for (size_t t = 0; t <= scene_.textures.size(); t++) {
        const bool real = t < scene_.textures.size() && used[t];
        const std::string name = real ? fmt::format("texture {}", t) : "texture white";
        images_.push_back(make_texture(device_, name, real ? scene_.images[scene_.textures[t].image] : white));
        samplers_.emplace_back(device_, name, real ? sampler_shape(scene_.textures[t]) : SamplerShape{});
    }
    for (size_t t = 0; t < images_.size(); t++) {
        const std::pair<const DeviceImage*, const Sampler*> texture{&images_[t], &samplers_[t]};
        sets_.emplace_back(pass_, std::span(&texture, 1));
    }
}

void Rasterizer::pose(const PosedScene& pose) {
    low_ = glm::vec3(INFINITY);
    high_ = -low_;
    for (Draw& draw : draws_) {
        pose_vertices(scene_, pose, draw.node, *draw.primitive, posed_);
        draw.mirrored = posed_.mirrored;
        MovingVertex* to = moving_.as<MovingVertex>() + draw.first_vertex;
        for (size_t v = 0; v < posed_.positions.size(); v++) {
            to[v] = {posed_.positions[v], posed_.normals[v]};
            low_ = glm::min(low_, posed_.positions[v]);
            high_ = glm::max(high_, posed_.positions[v]);
        }
    }
}

RasterPicture Rasterizer::draw(const Camera& camera, double near_m) {
    assert(camera.width * kSupersample == width_ && camera.height * kSupersample == height_ && "the picture size");
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

// Of the target: where the posed box can be seen, in whole pixels of the camera, one at least.
VkRect2D Rasterizer::visible_part(const glm::dmat4& clip_from_world) const {
    const glm::dvec2 size(width_ / kSupersample, height_ / kSupersample);
    glm::dvec2 low = size, high(0);
    for (int corner = 0; corner < 8; corner++) {
        const glm::dvec3 place(corner & 1 ? high_.x : low_.x, corner & 2 ? high_.y : low_.y,
                               corner & 4 ? high_.z : low_.z);
        const glm::dvec4 clip = clip_from_world * glm::dvec4(place, 1);
        const bool in_front = clip.w > clip.z && std::isfinite(clip.w);  // beyond the near plane
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
        const PassScope scope(commands_, "raster");
        for (const DeviceImage* colour : {&samples_, &target_})
            move_layout(commands_, *colour, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        move_layout(commands_, depth_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        begin_rendering(part);
        record_draws(clip_from_world, false);
        record_draws(clip_from_world, true);
        vkCmdEndRendering(commands_.handle());
    }
    move_layout(commands_, target_, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    copy(commands_, target_, part, readback_);
    host_barrier(commands_);
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
    const VkBuffer streams[] = {moving_.buffer, fixed_.buffer};
    const VkDeviceSize offsets[] = {0, 0};
    vkCmdBindVertexBuffers(commands_.handle(), 0, 2, streams, offsets);
    vkCmdBindIndexBuffer(commands_.handle(), indices_.buffer, 0, VK_INDEX_TYPE_UINT32);
}

// Blended materials come after all others and leave the depth alone; among themselves they keep the file's order.
void Rasterizer::record_draws(const glm::mat4& clip_from_world, bool blended) {
    VkCommandBuffer to = commands_.handle();
    for (const Draw& draw : draws_) {
        const GltfMaterial& material = material_of(scene_, draw.material);
        if ((material.alpha == GltfAlpha::kBlend) != blended) continue;
        RasterPush push{};
        push.clip_from_world = clip_from_world;
        push.base_colour = material.base_color;
        push.alpha_cutoff = material.alpha == GltfAlpha::kMask ? material.alpha_cutoff : -1;
        push.opaque = blended ? 0 : 1;
        push.sky = material.unlit ? 0 : kSkyShare;
        const size_t texture = material.texture < 0 ? scene_.textures.size() : static_cast<size_t>(material.texture);
        const VkDescriptorSet set = sets_[texture].handle();
        vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.layout(), 0, 1, &set, 0, nullptr);
        vkCmdPushConstants(to, pass_.layout(), kDrawStages, 0, sizeof(push), &push);
        vkCmdSetCullMode(to, material.double_sided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
        vkCmdSetFrontFace(to, draw.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
        vkCmdSetDepthWriteEnable(to, !blended);
        vkCmdDrawIndexed(to, static_cast<uint32_t>(draw.primitive->indices.size()), 1, draw.first_index,
                         static_cast<int32_t>(draw.first_vertex), 0);
    }
}

glm::dmat4 clip_from_world(const Camera& camera, double near_m) {
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

}  // namespace neuvv
