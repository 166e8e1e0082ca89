#include "render/set_raster.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/raster.h"
#include "spirv/set.frag.h"
#include "spirv/set.vert.h"
#include "spirv/set_background.frag.h"
#include "spirv/set_background.vert.h"
#include "spirv/set_masked.frag.h"
#include "spirv/set_shadow.frag.h"
#include "spirv/set_shadow.vert.h"
#include "spirv/set_transparent.frag.h"

namespace neuvv {

namespace {

constexpr VkFormat kColour = VK_FORMAT_R16G16B16A16_SFLOAT, kMetres = VK_FORMAT_R32_SFLOAT;
constexpr uint32_t kInfinityBits = 0x7f800000u;

GraphicsShape surface_shape(std::span<const uint32_t> fragment, std::vector<VkFormat> colours, bool blend) {
    GraphicsShape shape;
    shape.vertex_spirv = set_vert;
    shape.fragment_spirv = fragment;
    describe_streams(SceneDetail::kSurface, shape);
    shape.colours = std::move(colours);
    shape.blend = blend;
    return shape;
}

GraphicsShape shadow_shape() {
    GraphicsShape shape;
    shape.vertex_spirv = set_shadow_vert;
    shape.fragment_spirv = set_shadow_frag;
    describe_streams(SceneDetail::kBase, shape);
    std::erase_if(shape.attributes, [](const auto& attribute) { return attribute.location == kRasterNormal; });
    shape.colours = {};
    return shape;
}

GraphicsShape background_shape() {
    GraphicsShape shape;
    shape.vertex_spirv = set_background_vert;
    shape.fragment_spirv = set_background_frag;
    shape.colours = {kColour, kMetres};
    shape.blend = false;
    shape.nearer = VK_COMPARE_OP_GREATER_OR_EQUAL;  // infinity where nothing stands
    return shape;
}

SetMaterial packed_material(const GltfMaterial& material) {
    SetMaterial out{};
    out.base_colour = material.base_color;
    out.emissive = glm::vec4(material.emissive, material.unlit ? 1 : 0);
    out.surface = {material.metallic, material.roughness, material.normal_scale,
                   material.map(GltfMap::kOcclusion) >= 0 ? material.occlusion_strength : 0};
    out.alpha.x = material.alpha == GltfAlpha::kMask ? material.alpha_cutoff : -1;
    out.alpha.y = material.alpha == GltfAlpha::kBlend ? 0 : 1;
    return out;
}

bool is_srgb(size_t map) {
    return map == static_cast<size_t>(GltfMap::kEmissive);
}

}  // namespace

SetRaster::SetRaster(const Device& device, const GltfScene& scene, uint32_t width, uint32_t height, uint32_t views,
                     const Image* environment)
    : scene_(scene),
      width_(width),
      height_(height),
      geometry_(device, scene, SceneDetail::kSurface),
      solid_(device, "set", surface_shape(set_frag, {kColour, kMetres}, false)),
      masked_(device, "set masked", surface_shape(set_masked_frag, {kColour, kMetres}, false)),
      blended_(device, "set transparent", surface_shape(set_transparent_frag, {kColour, kColour}, true)),
      shadow_(device, "set shadow", shadow_shape()),
      background_(device, "set background", background_shape()) {
    make_buffers(device, views);
    make_images(device, views);
    upload_environment(device, environment);
    make_materials(device);
    make_sets(device);
    given_lights_.reserve(kMaxSetLights);
    for (const SceneDraw& draw : geometry_.draws)
        has_transparent_ |= material_at(scene, draw.material).alpha == GltfAlpha::kBlend;
    order_.reserve(geometry_.draws.size());
    pack();
}

void SetRaster::make_buffers(const Device& device, uint32_t views) {
    const uint64_t texels = uint64_t{views} * width_ * height_;
    constexpr uint64_t kSetMap = uint64_t{kSetShadowSide} * kSetShadowSide,
                       kPerformerMap = uint64_t{kPerformerShadowSide} * kPerformerShadowSide;
    colour = Buffer(device, "set colour", 8 * texels, MemoryKind::kDevice, kColour);
    front = Buffer(device, "set front", 8 * texels, MemoryKind::kDevice, kColour);
    depth = Buffer(device, "set depth", 4 * texels, MemoryKind::kDevice, kMetres);
    volume_depth = Buffer(device, "set volume depth", 4 * texels, MemoryKind::kDevice, kMetres);
    lights_buffer = Buffer(device, "set lights", sizeof(ShaderLights), MemoryKind::kUpload);
    set_shadow_maps = Buffer(device, "set shadow maps", 4 * kMaxShadows * kSetMap, MemoryKind::kDevice, kMetres);
    performer_shadows = Buffer(device, "performer shadows", 8 * kMaxShadows * kPerformerMap, MemoryKind::kDevice,
                               VK_FORMAT_R32G32_SFLOAT);
    run_once(device, "set buffers", [&](Commands& commands) {
        for (const Buffer* nothing : {&colour, &front, &set_shadow_maps, &performer_shadows})
            fill(commands, *nothing, 0);
        for (const Buffer* far : {&depth, &volume_depth}) fill(commands, *far, kInfinityBits);
    });
}

void SetRaster::make_images(const Device& device, uint32_t views) {
    constexpr VkImageUsageFlags kColourUse = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    constexpr VkImageUsageFlags kDepthUse = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    for (uint32_t view = 0; view < views; view++) {
        const std::string of_view = " " + std::to_string(view);
        colours_.emplace_back(device, "set colour" + of_view, ImageShape{width_, height_, kColour, kColourUse});
        depths_.emplace_back(device, "set depth" + of_view,
                             ImageShape{width_, height_, VK_FORMAT_D32_SFLOAT, kDepthUse});
    }
    metres_ = DeviceImage(device, "set metres", {width_, height_, kMetres, kColourUse});
    front_ = DeviceImage(device, "set front", {width_, height_, kColour, kColourUse});
    shadow_depth_ = DeviceImage(
        device, "set shadow depth",
        {kSetShadowSide, kSetShadowSide, VK_FORMAT_D32_SFLOAT, kDepthUse | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
}

void SetRaster::upload_environment(const Device& device, const Image* picture) {
    const Environment environment = picture ? make_environment(*picture) : dark_environment();
    std::vector<std::vector<uint8_t>> levels;
    for (const std::vector<uint16_t>& level : environment.levels) {
        levels.emplace_back(level.size() * sizeof(uint16_t));
        std::memcpy(levels.back().data(), level.data(), levels.back().size());
    }
    environment_ = DeviceImage(
        device, "environment",
        {environment.width, environment.height, kColour, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
         VK_SAMPLE_COUNT_1_BIT, static_cast<uint32_t>(levels.size())});
    upload_levels(device, environment_, levels);
    SamplerShape shape;
    shape.wrap_v = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    environment_sampler_ = Sampler(device, "environment", shape);
    irradiance_ = environment.irradiance;
    last_level_ = static_cast<float>(levels.size() - 1);
    has_environment_ = picture != nullptr;
}

// Material 0 is glTF's default one.
void SetRaster::make_materials(const Device& device) {
    textures_ = make_textures(device);
    std::vector<SetMaterial> packed;
    for (int32_t m = -1; m < static_cast<int32_t>(scene_.materials.size()); m++) {
        const GltfMaterial& material = material_at(scene_, m);
        packed.push_back(packed_material(material));
        add_texture(device, scene_, textures_, material.texture, true);
        for (size_t map = 0; map < kGltfMaps; map++)
            add_texture(device, scene_, textures_, material.maps[map], is_srgb(map));
    }
    materials_ = Buffer(device, "set materials", packed.size() * sizeof(SetMaterial), MemoryKind::kUpload,
                        VK_FORMAT_R32G32B32A32_SFLOAT);
    std::memcpy(materials_.mapped, packed.data(), packed.size() * sizeof(SetMaterial));
}

void SetRaster::make_sets(const Device& device) {
    using Texture = std::pair<const DeviceImage*, const Sampler*>;
    const Texture around{&environment_, &environment_sampler_};
    for (int32_t m = -1; m < static_cast<int32_t>(scene_.materials.size()); m++) {
        const GltfMaterial& material = material_at(scene_, m);
        const auto texture = [&](int32_t index, bool srgb) -> Texture {
            const SceneTextures::Entry& entry = textures_.entries[add_texture(device, scene_, textures_, index, srgb)];
            return {&entry.image, &entry.sampler};
        };
        std::vector<Texture> bound{texture(material.texture, true)};
        for (size_t map = 0; map < kGltfMaps; map++) bound.push_back(texture(material.maps[map], is_srgb(map)));
        bound.push_back(around);
        for (const auto& [pass, sets] : {std::pair{&solid_, &solid_sets_}, std::pair{&masked_, &masked_sets_},
                                         std::pair{&blended_, &blended_sets_}})
            sets->emplace_back(
                *pass, bound,
                std::initializer_list<std::pair<uint32_t, const Buffer*>>{{kSetMaterials, &materials_},
                                                                          {kSetLights, &lights_buffer},
                                                                          {kSetShadowMaps, &set_shadow_maps},
                                                                          {kSetPerformerShadows, &performer_shadows},
                                                                          {kSetVolumeDepth, &volume_depth}});
        shadow_sets_.emplace_back(
            shadow_, std::span(bound).first(1),
            std::initializer_list<std::pair<uint32_t, const Buffer*>>{{kSetMaterials, &materials_}});
    }
    background_set_ = TextureSet(background_, std::span(&around, 1), {{kSetLights, &lights_buffer}});
}

WorldBox SetRaster::box() const {
    return {geometry_.low, geometry_.high};
}

void SetRaster::pose(const PosedScene& pose) {
    if (!pose_geometry(geometry_, pose)) return;
    shadows_old_ = true;
    pack();
}

void SetRaster::light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows) {
    given_lights_.assign(lights.begin(), lights.begin() + std::min<ptrdiff_t>(std::ssize(lights), kMaxSetLights));
    ambient_ = ambient;
    shadows_ = shadows;
    pack();
}

void SetRaster::shadows_of(const std::optional<WorldBox>& performers) {
    if (performers == performers_) return;
    performers_ = performers;
    pack();
}

// Lights as shaders see them; maps are drawn again where one's matrix is another than before.
void SetRaster::pack() {
    const ShaderLights before = packed_;
    packed_ = pack_lights(given_lights_, ambient_, shadows_, irradiance_, box(), performers_);
    if (!has_environment_) packed_.environment.x = 0;
    packed_.environment.y = last_level_;
    for (uint32_t i = 0; i < packed_.count; i++)
        if (packed_.light[i].shadow != kNoShadow)
            shadows_old_ |= i >= before.count || packed_.light[i].shadow != before.light[i].shadow ||
                            packed_.light[i].clip_from_world != before.light[i].clip_from_world;
    std::memcpy(lights_buffer.mapped, &packed_, sizeof(packed_));
}

}  // namespace neuvv
