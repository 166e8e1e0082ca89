#include "render/set/set_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <tuple>

#include "render/set/set_targets.h"
#include "spirv/set.frag.h"
#include "spirv/set.vert.h"
#include "spirv/set_masked.frag.h"
#include "spirv/set_shadow.frag.h"
#include "spirv/set_shadow.vert.h"
#include "spirv/set_transparent.frag.h"

namespace neuvv::render {

namespace {

gpu::GraphicsShape surface_shape(std::span<const uint32_t> fragment, std::vector<VkFormat> colours, bool blend) {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_vert;
    shape.fragment_spirv = fragment;
    describe_streams(SceneDetail::kSurface, shape);
    shape.colours = std::move(colours);
    shape.blend = blend;
    return shape;
}

gpu::GraphicsShape shadow_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_shadow_vert;
    shape.fragment_spirv = set_shadow_frag;
    describe_streams(SceneDetail::kBase, shape);
    std::erase_if(shape.attributes, [](const auto& attribute) { return attribute.location == kRasterNormal; });
    shape.colours = {};
    return shape;
}

SetMaterial packed_material(const stage::GltfMaterial& material) {
    SetMaterial out{};
    out.base_colour = material.base_color;
    out.emissive = glm::vec4(material.emissive, material.unlit ? 1 : 0);
    out.surface = {material.metallic, material.roughness, material.normal_scale,
                   material.map(stage::GltfMap::kOcclusion) >= 0 ? material.occlusion_strength : 0};
    out.alpha.x = material.alpha == stage::GltfAlpha::kMask ? material.alpha_cutoff : -1;
    out.alpha.y = material.alpha == stage::GltfAlpha::kBlend ? 0 : 1;
    return out;
}

bool is_srgb(size_t map) {
    return map == static_cast<size_t>(stage::GltfMap::kEmissive);
}

// Whether the materials of two scenes look the same at each index if the textures do.
bool same_materials(const stage::GltfScene& a, const stage::GltfScene& b) {
    const auto same = [](const stage::GltfMaterial& one, const stage::GltfMaterial& other) {
        const SetMaterial packed = packed_material(one), other_packed = packed_material(other);
        return std::ranges::equal(std::as_bytes(std::span(&packed, 1)), std::as_bytes(std::span(&other_packed, 1))) &&
               one.texture == other.texture && one.maps == other.maps && one.alpha == other.alpha &&
               one.double_sided == other.double_sided;
    };
    return std::equal(a.materials.begin(), a.materials.end(), b.materials.begin(), b.materials.end(), same);
}

}  // namespace

SetMeshes::SetMeshes(const gpu::Device& device, const stage::GltfScene& scene, const SetSurroundings& around)
    : device_(device),
      scene_(&scene),
      geometry_(device, scene, SceneDetail::kSurface),
      solid_(device, "set",
             surface_shape(device.buffers().fitting(set_frag, set_frag_storage), {kSetColour, kSetMetres}, false)),
      masked_(device, "set masked",
              surface_shape(device.buffers().fitting(set_masked_frag, set_masked_frag_storage),
                            {kSetColour, kSetMetres}, false)),
      blended_(device, "set transparent",
               surface_shape(device.buffers().fitting(set_transparent_frag, set_transparent_frag_storage),
                             {kSetColour, kSetColour}, true)),
      shadow_(device, "set shadow", shadow_shape()) {
    surfaces_ = make_surfaces(scene, around, std::make_shared<SceneTextures>(make_textures(device)));
    find_blended();
}

bool SetMeshes::change(const stage::GltfScene& scene, const SetSurroundings& around, bool same_environment) {
    const bool same_maps = same_textures(*scene_, scene), same_shapes = has_vertices_of(geometry_, scene);
    const bool same_surfaces = same_maps && same_materials(*scene_, scene) && same_environment;
    std::optional<SceneGeometry> geometry;
    if (!same_shapes) geometry.emplace(device_, scene, SceneDetail::kSurface);
    if (!same_surfaces)
        surfaces_ = make_surfaces(
            scene, around, same_maps ? surfaces_.textures : std::make_shared<SceneTextures>(make_textures(device_)));
    // Nothing may fail from here on.
    if (geometry)
        geometry_ = std::move(*geometry);
    else
        repoint_geometry(geometry_, scene);
    scene_ = &scene;
    find_blended();
    return !same_shapes || !same_surfaces;
}

void SetMeshes::bind(const SetSurroundings& around) {
    surfaces_ = make_surfaces(*scene_, around, surfaces_.textures);
}

// `textures` may be empty or have textures of this scene; missing ones are added. Material 0 is glTF's default
// material.
SetMeshes::Surfaces SetMeshes::make_surfaces(const stage::GltfScene& scene, const SetSurroundings& around,
                                             std::shared_ptr<SceneTextures> textures) const {
    Surfaces surfaces;
    surfaces.textures = std::move(textures);
    std::vector<SetMaterial> packed;
    for (int32_t m = -1; m < static_cast<int32_t>(scene.materials.size()); ++m)
        packed.push_back(packed_material(material_at(scene, m)));
    surfaces.materials = gpu::Buffer(device_, "set materials", packed.size() * sizeof(SetMaterial),
                                     gpu::MemoryKind::kUpload, VK_FORMAT_R32G32B32A32_SFLOAT);
    std::memcpy(surfaces.materials.mapped, packed.data(), packed.size() * sizeof(SetMaterial));
    using Texture = std::pair<const gpu::DeviceImage*, const gpu::Sampler*>;
    for (int32_t m = -1; m < static_cast<int32_t>(scene.materials.size()); ++m) {
        const stage::GltfMaterial& material = material_at(scene, m);
        std::vector<size_t> entries{add_texture(device_, scene, *surfaces.textures, material.texture, true)};
        for (size_t map = 0; map < stage::kGltfMaps; ++map)
            entries.push_back(add_texture(device_, scene, *surfaces.textures, material.maps[map], is_srgb(map)));
        std::vector<Texture> bound;  // taken once no more entries are added, as adding may move them
        for (const size_t entry : entries)
            bound.emplace_back(&surfaces.textures->entries[entry].image, &surfaces.textures->entries[entry].sampler);
        bound.emplace_back(&around.environment.image, &around.environment.sampler);
        for (const auto& [pass, sets] : {std::pair{&solid_, &surfaces.solid}, std::pair{&masked_, &surfaces.masked},
                                         std::pair{&blended_, &surfaces.blended}})
            sets->emplace_back(*pass, bound,
                               std::initializer_list<std::pair<uint32_t, const gpu::Buffer*>>{
                                   {kSetMaterials, &surfaces.materials},
                                   {kSetLights, &around.lighting.lights_buffer},
                                   {kSetShadowMaps, &around.lighting.set_shadow_maps},
                                   {kSetPerformerShadows, &around.lighting.performer_shadows},
                                   {kSetVolumeDepth, &around.volume_depth}});
        surfaces.shadow.emplace_back(
            shadow_, std::span(bound).first(1),
            std::initializer_list<std::pair<uint32_t, const gpu::Buffer*>>{{kSetMaterials, &surfaces.materials}});
    }
    return surfaces;
}

void SetMeshes::find_blended() {
    has_blended_ = false;
    for (const SceneDraw& draw : geometry_.draws)
        has_blended_ |= material_at(*scene_, draw.material).alpha == stage::GltfAlpha::kBlend;
    order_.reserve(geometry_.draws.size());
}

// Sorts by the centres of the primitives' boxes, and by the file's order at equal distances.
void SetMeshes::sort_far_to_near(const glm::vec3& eye) {
    order_.clear();
    for (uint32_t i = 0; i < geometry_.draws.size(); ++i) {
        const SceneDraw& one = geometry_.draws[i];
        const float distance = glm::length(0.5f * (one.low + one.high) - eye);
        order_.emplace_back(std::isfinite(distance) ? -distance : 0, i);  // not finite where vertices overflow
    }
    std::sort(order_.begin(), order_.end());
}

void SetMeshes::draw_solid(gpu::Commands& commands, const SetPush& push) {
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

void SetMeshes::draw_blended(gpu::Commands& commands, const SetPush& push) {
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

void SetMeshes::draw_shadowing(gpu::Commands& commands, const SetPush& push) const {
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, shadow_.pipeline());
    bind_streams(commands, geometry_);
    vkCmdSetDepthWriteEnable(commands.handle(), VK_TRUE);
    for (const SceneDraw& one : geometry_.draws)
        if (material_at(*scene_, one.material).alpha != stage::GltfAlpha::kBlend)
            draw(commands, shadow_, surfaces_.shadow, one, push);
}

void SetMeshes::draw(gpu::Commands& commands, const gpu::GraphicsPass& pass, const std::vector<gpu::TextureSet>& sets,
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
