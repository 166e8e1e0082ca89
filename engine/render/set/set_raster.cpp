#include "render/set/set_raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <span>

#include "render/set/raster.h"
#include "spirv/set.frag.h"
#include "spirv/set.vert.h"
#include "spirv/set_background.frag.h"
#include "spirv/set_background.vert.h"
#include "spirv/set_catcher.frag.h"
#include "spirv/set_catcher.vert.h"
#include "spirv/set_hidden.frag.h"
#include "spirv/set_hidden.vert.h"
#include "spirv/set_masked.frag.h"
#include "spirv/set_shadow.frag.h"
#include "spirv/set_shadow.vert.h"
#include "spirv/set_transparent.frag.h"

namespace neuvv::render {

namespace {

constexpr VkFormat kColour = VK_FORMAT_R16G16B16A16_SFLOAT, kMetres = VK_FORMAT_R32_SFLOAT;
constexpr VkImageUsageFlags kDepthUse = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
constexpr uint32_t kInfinityBits = 0x7f800000u;

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

gpu::GraphicsShape background_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_background_vert;
    shape.fragment_spirv = set_background_frag;
    shape.colours = {kColour, kMetres};
    shape.blend = false;
    shape.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;  // so that it fills where the depth is infinite
    return shape;
}

gpu::GraphicsShape hidden_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_hidden_vert;
    shape.fragment_spirv = set_hidden_frag;
    shape.streams = {{0, sizeof(glm::vec2), VK_VERTEX_INPUT_RATE_VERTEX}};
    shape.attributes = {{0, 0, VK_FORMAT_R32G32_SFLOAT, 0}};
    shape.colours = {kColour, kMetres};
    shape.blend = false;
    return shape;
}

gpu::GraphicsShape catcher_shape(const gpu::Device& device) {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_catcher_vert;
    shape.fragment_spirv = device.buffers().fitting(set_catcher_frag, set_catcher_frag_storage);
    shape.colours = {kColour, kMetres};
    shape.blend = false;
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

SetEnvironment::SetEnvironment(const gpu::Device& device, const media::Image* source) : has_image(source != nullptr) {
    const Environment environment = source ? make_environment(*source) : dark_environment();
    std::vector<std::vector<uint8_t>> levels;
    for (const std::vector<uint16_t>& level : environment.levels) {
        levels.emplace_back(level.size() * sizeof(uint16_t));
        std::memcpy(levels.back().data(), level.data(), levels.back().size());
    }
    image = gpu::DeviceImage(
        device, "environment",
        {environment.width, environment.height, kColour, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
         VK_SAMPLE_COUNT_1_BIT, static_cast<uint32_t>(levels.size())});
    gpu::upload_levels(device, image, levels);
    gpu::SamplerShape shape;
    shape.wrap_v = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    sampler = gpu::Sampler(device, "environment", shape);
    irradiance = environment.irradiance;
    last_level = static_cast<float>(levels.size() - 1);
}

SetRaster::SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height,
                     uint32_t views, const media::Image* environment)
    : SetRaster(device, scene, width, height, views, std::make_shared<SetEnvironment>(device, environment)) {}

SetRaster::SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height,
                     uint32_t views, std::shared_ptr<const SetEnvironment> environment)
    : device_(device),
      scene_(&scene),
      width_(width),
      height_(height),
      geometry_(device, scene, SceneDetail::kSurface),
      solid_(device, "set",
             surface_shape(device.buffers().fitting(set_frag, set_frag_storage), {kColour, kMetres}, false)),
      masked_(
          device, "set masked",
          surface_shape(device.buffers().fitting(set_masked_frag, set_masked_frag_storage), {kColour, kMetres}, false)),
      blended_(device, "set transparent",
               surface_shape(device.buffers().fitting(set_transparent_frag, set_transparent_frag_storage),
                             {kColour, kColour}, true)),
      shadow_(device, "set shadow", shadow_shape()),
      background_(device, "set background", background_shape()),
      environment_(std::move(environment)) {
    make_targets(views);
    make_light_buffers();
    surfaces_ = make_surfaces(scene, *environment_, std::make_shared<SceneTextures>(make_textures(device)));
    given_lights_.reserve(kMaxSetLights);
    find_transparent();
    pack();
}

void SetRaster::change(const stage::GltfScene& scene, std::shared_ptr<const SetEnvironment> environment) {
    const bool same_maps = same_textures(*scene_, scene), same_shapes = has_vertices_of(geometry_, scene);
    const bool same_surfaces = same_maps && same_materials(*scene_, scene) && environment == environment_;
    std::optional<SceneGeometry> geometry;
    if (!same_shapes) geometry.emplace(device_, scene, SceneDetail::kSurface);
    if (!same_surfaces)
        surfaces_ =
            make_surfaces(scene, *environment,
                          same_maps ? surfaces_.textures : std::make_shared<SceneTextures>(make_textures(device_)));
    // Nothing may fail from here on.
    if (geometry)
        geometry_ = std::move(*geometry);
    else
        repoint_geometry(geometry_, scene);
    scene_ = &scene;
    environment_ = std::move(environment);
    shadows_outdated_ |= !same_shapes || !same_surfaces;
    const bool had_transparent = has_transparent();
    find_transparent();
    pack();
    clear_front(had_transparent);
}

void SetRaster::resize(uint32_t width, uint32_t height) {
    const uint32_t views = this->views();
    width_ = width;
    height_ = height;
    make_targets(views);
    surfaces_ = make_surfaces(*scene_, *environment_, surfaces_.textures);
}

// Creates the buffers and images that have the size of a view.
void SetRaster::make_targets(uint32_t views) {
    const uint64_t texels = uint64_t{views} * width_ * height_;
    colour = gpu::Buffer(device_, "set colour", 8 * texels, gpu::MemoryKind::kDevice, kColour);
    front = gpu::Buffer(device_, "set front", 8 * texels, gpu::MemoryKind::kDevice, kColour);
    depth = gpu::Buffer(device_, "set depth", 4 * texels, gpu::MemoryKind::kDevice, kMetres);
    volume_depth = gpu::Buffer(device_, "set volume depth", 4 * texels, gpu::MemoryKind::kDevice, kMetres);
    make_images(views);
    gpu::run_once(device_, "set buffers", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* nothing : {&colour, &front}) gpu::fill(commands, *nothing, 0);
        for (const gpu::Buffer* far : {&depth, &volume_depth}) gpu::fill(commands, *far, kInfinityBits);
    });
}

void SetRaster::make_images(uint32_t views) {
    constexpr VkImageUsageFlags kColourUse = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    colours_.resize(views);
    depths_.resize(views);
    for (uint32_t view = 0; view < views; ++view) {
        const std::string of_view = " " + std::to_string(view);
        colours_[view] = gpu::DeviceImage(device_, "set colour" + of_view, {width_, height_, kColour, kColourUse});
        depths_[view] =
            gpu::DeviceImage(device_, "set depth" + of_view, {width_, height_, VK_FORMAT_D32_SFLOAT, kDepthUse});
    }
    metres_ = gpu::DeviceImage(device_, "set metres", {width_, height_, kMetres, kColourUse});
    front_ = gpu::DeviceImage(device_, "set front", {width_, height_, kColour, kColourUse});
}

void SetRaster::make_light_buffers() {
    constexpr uint64_t kSetMap = uint64_t{kSetShadowSide} * kSetShadowSide,
                       kPerformerMap = uint64_t{kPerformerShadowSide} * kPerformerShadowSide;
    lights_buffer = gpu::Buffer(device_, "set lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice);
    set_shadow_maps =
        gpu::Buffer(device_, "set shadow maps", 4 * kMaxShadows * kSetMap, gpu::MemoryKind::kDevice, kMetres);
    performer_shadows = gpu::Buffer(device_, "performer shadows", 8 * kMaxShadows * kPerformerMap,
                                    gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_SFLOAT);
    shadow_depth_ = gpu::DeviceImage(
        device_, "set shadow depth",
        {kSetShadowSide, kSetShadowSide, VK_FORMAT_D32_SFLOAT, kDepthUse | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    gpu::run_once(device_, "shadow maps", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* nothing : {&set_shadow_maps, &performer_shadows}) gpu::fill(commands, *nothing, 0);
    });
}

// `textures` may be empty or have textures of this scene; missing ones are added. Material 0 is glTF's default
// material.
SetRaster::Surfaces SetRaster::make_surfaces(const stage::GltfScene& scene, const SetEnvironment& environment,
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
    const Texture environment_texture{&environment.image, &environment.sampler};
    for (int32_t m = -1; m < static_cast<int32_t>(scene.materials.size()); ++m) {
        const stage::GltfMaterial& material = material_at(scene, m);
        std::vector<size_t> entries{add_texture(device_, scene, *surfaces.textures, material.texture, true)};
        for (size_t map = 0; map < stage::kGltfMaps; ++map)
            entries.push_back(add_texture(device_, scene, *surfaces.textures, material.maps[map], is_srgb(map)));
        std::vector<Texture> bound;  // taken once no more entries are added, as adding may move them
        for (const size_t entry : entries)
            bound.emplace_back(&surfaces.textures->entries[entry].image, &surfaces.textures->entries[entry].sampler);
        bound.push_back(environment_texture);
        for (const auto& [pass, sets] : {std::pair{&solid_, &surfaces.solid}, std::pair{&masked_, &surfaces.masked},
                                         std::pair{&blended_, &surfaces.blended}})
            sets->emplace_back(*pass, bound,
                               std::initializer_list<std::pair<uint32_t, const gpu::Buffer*>>{
                                   {kSetMaterials, &surfaces.materials},
                                   {kSetLights, &lights_buffer},
                                   {kSetShadowMaps, &set_shadow_maps},
                                   {kSetPerformerShadows, &performer_shadows},
                                   {kSetVolumeDepth, &volume_depth}});
        surfaces.shadow.emplace_back(
            shadow_, std::span(bound).first(1),
            std::initializer_list<std::pair<uint32_t, const gpu::Buffer*>>{{kSetMaterials, &surfaces.materials}});
    }
    surfaces.background =
        gpu::TextureSet(background_, std::span(&environment_texture, 1), {{kSetLights, &lights_buffer}});
    return surfaces;
}

void SetRaster::find_transparent() {
    has_transparent_ = false;
    for (const SceneDraw& draw : geometry_.draws)
        has_transparent_ |= material_at(*scene_, draw.material).alpha == stage::GltfAlpha::kBlend;
    order_.reserve(geometry_.draws.size());
}

void SetRaster::catch_shadows(std::optional<double> floor_m) {
    const bool had_transparent = has_transparent();
    catcher_floor_m_ = floor_m;
    if (floor_m && !catcher_) {
        catcher_.reset(new Catcher{{device_, "set shadow catcher", catcher_shape(device_)}, {}});
        catcher_->bound = gpu::TextureSet(catcher_->pass, {},
                                          {{kSetLights, &lights_buffer},
                                           {kSetShadowMaps, &set_shadow_maps},
                                           {kSetPerformerShadows, &performer_shadows}});
    }
    clear_front(had_transparent);
}

void SetRaster::clear_front(bool had_transparent) {
    if (had_transparent && !has_transparent())
        gpu::run_once(device_, "set front", [&](gpu::Commands& commands) { gpu::fill(commands, front, 0); });
}

WorldBox SetRaster::box() const {
    return {geometry_.low, geometry_.high};
}

bool SetRaster::has_pose(const stage::PosedScene& pose) const {
    return render::has_pose(geometry_, pose);
}

void SetRaster::pose(const stage::PosedScene& pose) {
    if (!pose_geometry(geometry_, pose)) return;
    shadows_outdated_ = true;
    pack();
}

void SetRaster::light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows) {
    given_lights_.assign(lights.begin(), lights.begin() + std::min<ptrdiff_t>(std::ssize(lights), kMaxSetLights));
    ambient_ = ambient;
    shadows_ = shadows;
    pack();
}

void SetRaster::set_shadow_casters(const std::optional<WorldBox>& performers) {
    if (performers == performers_) return;
    performers_ = performers;
    pack();
}

// Packs the lights for shaders. Shadow maps are drawn again where the matrix of one has changed.
void SetRaster::pack() {
    const ShaderLights before = packed_;
    packed_ = pack_lights(given_lights_, ambient_, shadows_, environment_->irradiance, box(), performers_);
    if (!environment_->has_image) packed_.environment.x = 0;
    packed_.environment.y = environment_->last_level;
    for (uint32_t i = 0; i < packed_.count; ++i)
        if (packed_.light[i].shadow != kNoShadow)
            shadows_outdated_ |= i >= before.count || packed_.light[i].shadow != before.light[i].shadow ||
                                 packed_.light[i].clip_from_world != before.light[i].clip_from_world;
}

void SetRaster::hide(std::span<const std::vector<glm::vec2>> corners) {
    assert((corners.empty() || corners.size() == views()) && "a list a view");
    std::vector<glm::vec2> all;
    std::vector<std::pair<uint32_t, uint32_t>> of_view;
    for (const auto& list : corners) {
        of_view.emplace_back(all.size(), list.size());
        all.insert(all.end(), list.begin(), list.end());
    }
    if (!hidden_ && all.empty()) return;
    if (!hidden_) hidden_.reset(new Hidden{{device_, "set hidden", hidden_shape()}, {}, {}});
    hidden_->of_view = std::move(of_view);
    const uint64_t bytes = all.size() * sizeof(glm::vec2);
    if (bytes > hidden_->corners.bytes)
        hidden_->corners = gpu::Buffer(device_, "hidden corners", bytes, gpu::MemoryKind::kUpload);
    if (bytes > 0) std::memcpy(hidden_->corners.mapped, all.data(), bytes);
}

}  // namespace neuvv::render
