#include "render/set/scene_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/error.h"
#include "render/set/raster.h"
#include "shared/raster.h"

namespace neuvv::render {

namespace {

struct MovingVertex {
    glm::vec3 position, normal;
};
struct FixedVertex {
    glm::vec2 uv;
    glm::vec4 colour;
};
struct MapUvs {
    glm::vec2 uv[stage::kGltfMaps];
};

// Calls visit(node, primitive) for each primitive that is drawn, in the order of SceneGeometry::draws.
template <typename Visit>
void for_each_drawn(const stage::GltfScene& scene, const Visit& visit) {
    for (uint32_t n = 0; n < scene.nodes.size(); ++n) {
        const stage::GltfNode& node = scene.nodes[n];
        if (!node.draws_mesh()) continue;
        for (const stage::GltfPrimitive& primitive : scene.meshes[static_cast<size_t>(node.mesh)].primitives)
            visit(n, primitive);
    }
}

void list_draws(SceneGeometry& to) {
    uint64_t vertices = 0, indices = 0;
    for_each_drawn(*to.scene, [&](uint32_t node, const stage::GltfPrimitive& primitive) {
        SceneDraw& draw = to.draws.emplace_back();
        draw.node = node;
        draw.primitive = &primitive;
        draw.first_vertex = static_cast<uint32_t>(vertices);
        draw.first_index = static_cast<uint32_t>(indices);
        draw.material = primitive.material;
        vertices += primitive.positions.size();
        indices += primitive.indices.size();
        if (vertices > INT32_MAX || indices > UINT32_MAX)
            throw RuntimeFailure(to.scene->file + ": more vertices than one image takes; use a smaller model");
    });
    to.vertex_count = static_cast<uint32_t>(vertices);
    to.index_count = static_cast<uint32_t>(indices);
}

template <typename T>
gpu::Buffer filled(const gpu::Device& device, const std::string& name, const std::vector<T>& values) {
    gpu::Buffer buffer(device, name, values.size() * sizeof(T), gpu::MemoryKind::kUpload);
    if (!values.empty()) std::memcpy(buffer.mapped, values.data(), values.size() * sizeof(T));
    return buffer;
}

void upload_fixed(const gpu::Device& device, SceneGeometry& to) {
    std::vector<FixedVertex> fixed;
    std::vector<uint32_t> indices;
    fixed.reserve(to.vertex_count);
    indices.reserve(to.index_count);
    for (const SceneDraw& draw : to.draws) {
        const stage::GltfPrimitive& from = *draw.primitive;
        for (size_t v = 0; v < from.positions.size(); ++v)
            fixed.push_back(
                {from.uvs.empty() ? glm::vec2(0) : from.uvs[v], from.colors.empty() ? glm::vec4(1) : from.colors[v]});
        indices.insert(indices.end(), from.indices.begin(), from.indices.end());
    }
    to.fixed = filled(device, "raster fixed vertices", fixed);
    to.indices = filled(device, "raster indices", indices);
}

void upload_map_uvs(const gpu::Device& device, SceneGeometry& to) {
    std::vector<MapUvs> uvs(to.vertex_count);
    for (const SceneDraw& draw : to.draws)
        for (size_t map = 0; map < stage::kGltfMaps; ++map) {
            const std::vector<glm::vec2>& from = draw.primitive->map_uvs[map];
            for (size_t v = 0; v < from.size(); ++v) uvs[draw.first_vertex + v].uv[map] = from[v];
        }
    to.map_uvs = filled(device, "raster map UVs", uvs);
}

// Compares bytes, at the speed of memory for any type of element.
template <typename Values>
bool same(const Values& a, const Values& b) {
    static_assert(std::is_trivially_copyable_v<typename Values::value_type>);
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

// Compares everything that is uploaded or posed.
bool same_vertices(const stage::GltfPrimitive& a, const stage::GltfPrimitive& b) {
    if (&a == &b) return true;  // the scenes share the mesh
    bool equal = same(a.positions, b.positions) && same(a.normals, b.normals) && same(a.uvs, b.uvs) &&
                 same(a.tangents, b.tangents) && same(a.colors, b.colors) && same(a.joints, b.joints) &&
                 same(a.weights, b.weights) && same(a.indices, b.indices) && a.targets.size() == b.targets.size();
    for (size_t map = 0; equal && map < stage::kGltfMaps; ++map) equal = same(a.map_uvs[map], b.map_uvs[map]);
    for (size_t i = 0; equal && i < a.targets.size(); ++i)
        equal =
            same(a.targets[i].positions, b.targets[i].positions) && same(a.targets[i].normals, b.targets[i].normals);
    return equal;
}

// Whether the vertices of the draw differ between the geometry's pose and the new one.
bool moved(const SceneGeometry& geometry, const SceneDraw& draw, const stage::PosedScene& to) {
    const stage::PosedScene& from = geometry.pose;
    const int32_t skin = geometry.scene->nodes[draw.node].skin;
    if (from.world_from_node.empty() || from.morph_weights[draw.node] != to.morph_weights[draw.node]) return true;
    if (skin < 0) return from.world_from_node[draw.node] != to.world_from_node[draw.node];
    return from.joint_matrices[static_cast<size_t>(skin)] != to.joint_matrices[static_cast<size_t>(skin)];
}

void pose_draw(SceneGeometry& geometry, const stage::PosedScene& pose, SceneDraw& draw) {
    stage::PosedVertices& posed = geometry.scratch;
    stage::pose_vertices(*geometry.scene, pose, draw.node, *draw.primitive, posed);
    draw.mirrored = posed.mirrored;
    draw.low = glm::vec3(INFINITY);
    draw.high = -draw.low;
    MovingVertex* to = geometry.moving.as<MovingVertex>() + draw.first_vertex;
    for (size_t v = 0; v < posed.positions.size(); ++v) {
        to[v] = {posed.positions[v], posed.normals[v]};
        draw.low = glm::min(draw.low, posed.positions[v]);
        draw.high = glm::max(draw.high, posed.positions[v]);
    }
    if (geometry.detail == SceneDetail::kSurface && !posed.tangents.empty())
        std::memcpy(geometry.tangents.as<glm::vec4>() + draw.first_vertex, posed.tangents.data(),
                    posed.tangents.size() * sizeof(glm::vec4));
}

}  // namespace

SceneGeometry::SceneGeometry(const gpu::Device& device, const stage::GltfScene& from, SceneDetail how)
    : scene(&from), detail(how) {
    list_draws(*this);
    moving = filled(device, "raster moving vertices", std::vector<MovingVertex>(vertex_count));
    upload_fixed(device, *this);
    if (detail == SceneDetail::kBase) return;
    tangents = filled(device, "raster tangents", std::vector<glm::vec4>(vertex_count, glm::vec4(0)));
    upload_map_uvs(device, *this);
}

bool has_vertices_of(const SceneGeometry& geometry, const stage::GltfScene& scene) {
    size_t drawn = 0;
    bool equal = true;
    for_each_drawn(scene, [&](uint32_t, const stage::GltfPrimitive& primitive) {
        equal = equal && drawn < geometry.draws.size() && same_vertices(*geometry.draws[drawn].primitive, primitive);
        ++drawn;
    });
    return equal && drawn == geometry.draws.size();
}

void repoint_geometry(SceneGeometry& geometry, const stage::GltfScene& scene) {
    bool same_nodes = true;
    size_t drawn = 0;
    for_each_drawn(scene, [&](uint32_t node, const stage::GltfPrimitive& primitive) {
        SceneDraw& draw = geometry.draws[drawn++];
        same_nodes = same_nodes && draw.node == node && geometry.scene->nodes[node].skin == scene.nodes[node].skin;
        draw.node = node;
        draw.primitive = &primitive;
        draw.material = primitive.material;
    });
    geometry.scene = &scene;
    if (!same_nodes) geometry.pose = {};  // poses are indexed by node
}

bool has_pose(const SceneGeometry& geometry, const stage::PosedScene& pose) {
    return std::none_of(geometry.draws.begin(), geometry.draws.end(),
                        [&](const SceneDraw& draw) { return moved(geometry, draw, pose); });
}

bool pose_geometry(SceneGeometry& geometry, const stage::PosedScene& pose) {
    bool any = false;
    for (SceneDraw& draw : geometry.draws) {
        if (!moved(geometry, draw, pose)) continue;
        pose_draw(geometry, pose, draw);
        any = true;
    }
    geometry.pose = pose;
    if (!any) return false;
    geometry.low = glm::vec3(INFINITY);
    geometry.high = -geometry.low;
    for (const SceneDraw& draw : geometry.draws) {
        geometry.low = glm::min(geometry.low, draw.low);
        geometry.high = glm::max(geometry.high, draw.high);
    }
    return true;
}

void describe_streams(SceneDetail detail, gpu::GraphicsShape& shape) {
    constexpr VkVertexInputRate kVertex = VK_VERTEX_INPUT_RATE_VERTEX;
    shape.streams = {{0, sizeof(MovingVertex), kVertex}, {1, sizeof(FixedVertex), kVertex}};
    shape.attributes = {{kRasterPosition, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(MovingVertex, position)},
                        {kRasterNormal, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(MovingVertex, normal)},
                        {kRasterUv, 1, VK_FORMAT_R32G32_SFLOAT, offsetof(FixedVertex, uv)},
                        {kRasterColour, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(FixedVertex, colour)}};
    if (detail == SceneDetail::kBase) return;
    shape.streams.push_back({2, sizeof(glm::vec4), kVertex});
    shape.streams.push_back({3, sizeof(MapUvs), kVertex});
    shape.attributes.push_back({kRasterTangent, 2, VK_FORMAT_R32G32B32A32_SFLOAT, 0});
    shape.attributes.push_back({kRasterMapUvs, 3, VK_FORMAT_R32G32B32A32_SFLOAT, 0});
    shape.attributes.push_back({kRasterMapUvs + 1, 3, VK_FORMAT_R32G32B32A32_SFLOAT, 2 * sizeof(glm::vec2)});
}

void bind_streams(gpu::Commands& commands, const SceneGeometry& geometry) {
    const VkBuffer streams[] = {geometry.moving.buffer, geometry.fixed.buffer, geometry.tangents.buffer,
                                geometry.map_uvs.buffer};
    const VkDeviceSize offsets[] = {0, 0, 0, 0};
    vkCmdBindVertexBuffers(commands.handle(), 0, geometry.detail == SceneDetail::kBase ? 2 : 4, streams, offsets);
    vkCmdBindIndexBuffer(commands.handle(), geometry.indices.buffer, 0, VK_INDEX_TYPE_UINT32);
}

const stage::GltfMaterial& material_at(const stage::GltfScene& scene, int32_t index) {
    static const stage::GltfMaterial kDefault;
    return index < 0 ? kDefault : scene.materials[static_cast<size_t>(index)];
}

namespace {

VkSamplerAddressMode address_mode(stage::GltfWrap wrap) {
    switch (wrap) {
        case stage::GltfWrap::kRepeat:
            return VK_SAMPLER_ADDRESS_MODE_REPEAT;
        case stage::GltfWrap::kMirroredRepeat:
            return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case stage::GltfWrap::kClampToEdge:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    }
    return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

gpu::SamplerShape sampler_shape(const stage::GltfTexture& texture) {
    gpu::SamplerShape shape;
    shape.wrap_u = address_mode(texture.wrap_u);
    shape.wrap_v = address_mode(texture.wrap_v);
    shape.magnification = texture.nearest_magnification ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    shape.minification = texture.nearest_minification ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    shape.mipmaps = texture.mipmaps;
    return shape;
}

gpu::DeviceImage make_texture(const gpu::Device& device, const std::string& name, const media::Image& image,
                              bool srgb) {
    const std::vector<std::vector<uint8_t>> levels = srgb ? mip_levels(image) : mip_levels_of_numbers(image);
    gpu::DeviceImage texture(device, name,
                             {image.width, image.height, srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                              VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_SAMPLE_COUNT_1_BIT,
                              static_cast<uint32_t>(levels.size())});
    gpu::upload_levels(device, texture, levels);
    return texture;
}

}  // namespace

bool same_textures(const stage::GltfScene& a, const stage::GltfScene& b) {
    const auto same_texture = [](const stage::GltfTexture& one, const stage::GltfTexture& other) {
        return one.image == other.image && one.wrap_u == other.wrap_u && one.wrap_v == other.wrap_v &&
               one.nearest_magnification == other.nearest_magnification &&
               one.nearest_minification == other.nearest_minification && one.mipmaps == other.mipmaps;
    };
    const auto same_image = [](const auto& one, const auto& other) {
        return one == other || (one && other && same(one->encoded, other->encoded));
    };
    return std::equal(a.textures.begin(), a.textures.end(), b.textures.begin(), b.textures.end(), same_texture) &&
           std::equal(a.images.begin(), a.images.end(), b.images.begin(), b.images.end(), same_image);
}

SceneTextures make_textures(const gpu::Device& device) {
    media::Image white(1, 1);
    white.rgba.assign(4, 255);
    SceneTextures textures;
    const std::string name = "texture white";
    textures.entries.push_back(
        {-1, true, make_texture(device, name, white, true), gpu::Sampler(device, name, gpu::SamplerShape{})});
    return textures;
}

size_t add_texture(const gpu::Device& device, const stage::GltfScene& scene, SceneTextures& textures, int32_t texture,
                   bool srgb) {
    if (texture < 0) return 0;
    for (size_t i = 1; i < textures.entries.size(); ++i)
        if (textures.entries[i].texture == texture && textures.entries[i].srgb == srgb) return i;
    const stage::GltfTexture& from = scene.textures[static_cast<size_t>(texture)];
    const std::string name = fmt::format("texture {}{}", texture, srgb ? "" : " as numbers");
    textures.entries.push_back({texture, srgb, make_texture(device, name, scene.images[from.image]->pixels, srgb),
                                gpu::Sampler(device, name, sampler_shape(from))});
    return textures.entries.size() - 1;
}

}  // namespace neuvv::render
