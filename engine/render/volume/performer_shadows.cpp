#include "render/volume/performer_shadows.h"

#include "render/volume/draw_order.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kSide = kPerformerShadowSide;
constexpr uint32_t kMapTiles = (kSide / kTile) * (kSide / kTile);
static_assert(kSide % kTile == 0);

// Around the finest leaves at any level, so that the maps of directional lights do not move where a level is switched.
std::optional<WorldBox> box_of_casting(const FieldLevels& levels, std::span<const Instance> instances) {
    std::optional<WorldBox> box;
    for (const Instance& instance : instances) {
        if (!instance.casts_shadow) continue;
        const Field& field = levels.finest(instance.field);
        const TransformedBox placed =
            transformed_box(field.leaves_min, field.leaves_max, instance.world_from_performer);
        const glm::dvec3 half = glm::abs(placed.half[0]) + glm::abs(placed.half[1]) + glm::abs(placed.half[2]);
        const glm::dvec3 low = placed.centre - half, high = placed.centre + half;
        box = box ? WorldBox{glm::min(box->first, low), glm::max(box->second, high)} : WorldBox{low, high};
    }
    return box;
}

}  // namespace

PerformerShadows::PerformerShadows(const gpu::Device& device, SetLighting& given, uint32_t instances)
    : lighting(given),
      target(device, kMaxShadows * (instances + 1), kMaxShadows * kMapTiles, kMaxShadows * kMapTiles),
      clearer(device, target),
      blur(device, target.rays, given.performer_shadows) {
    write_tiles({target, {kSide, kSide, 1, kMaxShadows}, {}});  // those of fewer lights come first
}

// Finds the lights that cast performers' shadows, and their cameras.
void PerformerShadows::prepare_lights(const FieldLevels& levels, std::span<const Instance> instances) {
    cameras.clear();
    maps.clear();
    const std::optional<WorldBox> box = box_of_casting(levels, instances);
    lighting.set_shadow_casters(box);
    if (!box || !lighting.lights().performer_shadows) return;
    for (uint32_t i = 0; i < lighting.lights().count; ++i) {
        if (lighting.lights().light[i].shadow == kNoShadow) continue;
        cameras.push_back(performer_shadow_camera(lighting.given_lights()[i], *box, kSide));
        maps.push_back(lighting.lights().light[i].shadow);
    }
}

void PerformerShadows::prepare(const FieldLevels& levels, std::span<const Instance> instances) {
    prepare_lights(levels, instances);
    drawn.clear();
    layout = {kSide, kSide, 1, static_cast<uint32_t>(cameras.size())};
    const TargetViews views{target, layout, cameras};
    if (cameras.empty()) return;
    write_cameras(views);
    for (const Instance& instance : instances) {
        if (!instance.casts_shadow) continue;
        auto one =
            write_instance_cameras(views, *levels.all[instance.field], instance, static_cast<uint32_t>(drawn.size()));
        if (!one) continue;
        one->shading = Shading::kNone;
        one->output = RayOutput::kLayerByDepth;
        drawn.push_back(*one);
    }
}

void record_performer_shadows(gpu::Commands& commands, PerformerShadows& shadows,
                              std::span<const std::unique_ptr<Performer>> performers, uint32_t target) {
    if (shadows.cameras.empty()) return;
    record_cameras(commands, shadows.target);
    record_clear_rays(commands, shadows.clearer);
    for (const DrawnInstance& instance : shadows.drawn)
        record_instance(commands, *performers[instance.field], target, instance, shadows.layout);
    record_shadow_blur(commands, shadows.blur, shadows.maps);
}

}  // namespace neuvv::render
