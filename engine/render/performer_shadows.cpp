#include "render/performer_shadows.h"

#include "render/draw_order.h"

#include "shared/shadow_blur.h"
#include "spirv/shadow_blur.comp.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kSide = kPerformerShadowSide;
constexpr uint32_t kMapTiles = (kSide / kTile) * (kSide / kTile);
static_assert(kSide % kTile == 0);

std::optional<WorldBox> box_of_casting(std::span<const Field* const> fields, std::span<const Instance> instances) {
    std::optional<WorldBox> box;
    for (const Instance& instance : instances) {
        if (!instance.casts_shadow) continue;
        const Field& field = *fields[instance.field];
        const PlacedBox placed = placed_box(field.leaves_min, field.leaves_max, instance.world_from_performer);
        const glm::dvec3 half = glm::abs(placed.half[0]) + glm::abs(placed.half[1]) + glm::abs(placed.half[2]);
        const glm::dvec3 low = placed.middle - half, high = placed.middle + half;
        box = box ? WorldBox{glm::min(box->first, low), glm::max(box->second, high)} : WorldBox{low, high};
    }
    return box;
}

}  // namespace

PerformerShadows::PerformerShadows(const gpu::Device& device, SetRaster& set, uint32_t instances)
    : set_(set),
      target_(device, kMaxShadows * (instances + 1), kMaxShadows * kMapTiles, kMaxShadows * kMapTiles),
      rows_(device, "shadow rows", uint64_t{8} * kSide * kSide, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_SFLOAT),
      along_rows_(device, "shadow blur", shadow_blur_comp, {0}),
      along_columns_(device, "shadow blur", shadow_blur_comp, {1}),
      rows_set_(along_rows_, {{kBlurRadiance, &target_.rays.radiance},
                              {kBlurDepth, &target_.rays.depth},
                              {kBlurFrom, &set.performer_shadows},  // not read
                              {kBlurTo, &rows_}}),
      columns_set_(along_columns_, {{kBlurRadiance, &target_.rays.radiance},
                                    {kBlurDepth, &target_.rays.depth},
                                    {kBlurFrom, &rows_},
                                    {kBlurTo, &set.performer_shadows}}) {}

// The lights that see performers, and from where.
void PerformerShadows::place_lights(std::span<const Field* const> fields, std::span<const Instance> instances) {
    cameras_.clear();
    maps_.clear();
    const std::optional<WorldBox> box = box_of_casting(fields, instances);
    set_.shadows_of(box);
    if (!box || !set_.lights().performer_shadows) return;
    for (uint32_t i = 0; i < set_.lights().count; i++) {
        if (set_.lights().light[i].shadow == kNoShadow) continue;
        cameras_.push_back(performer_shadow_camera(set_.given_lights()[i], *box, kSide));
        maps_.push_back(set_.lights().light[i].shadow);
    }
}

void PerformerShadows::place(std::span<const Field* const> fields, std::span<const Instance> instances) {
    place_lights(fields, instances);
    drawn_.clear();
    const ViewLayout layout{kSide, kSide, 1, static_cast<uint32_t>(cameras_.size())};
    const TargetViews views{target_, layout, cameras_};
    if (layout != layout_) place_tiles(views);
    layout_ = layout;
    if (cameras_.empty()) return;
    place_cameras(views);
    for (const Instance& instance : instances) {
        if (!instance.casts_shadow) continue;
        auto drawn = place_instance(views, *fields[instance.field], instance, static_cast<uint32_t>(drawn_.size()));
        if (!drawn) continue;
        drawn->shading = Shading::kNone;
        drawn->into = Into::kLayerByDepth;
        drawn_.push_back(*drawn);
    }
}

void record_performer_shadows(gpu::Commands& commands, PerformerShadows& shadows,
                              std::span<const std::unique_ptr<Performer>> performers, uint32_t target) {
    if (shadows.cameras_.empty()) return;
    record_clear(commands, shadows.target_.rays, shadows.layout_.ray_tiles());
    record_unseen(commands, shadows.target_.ranges);
    for (const DrawnInstance& instance : shadows.drawn_)
        record_instance(commands, *performers[instance.field], target, instance, shadows.layout_);
    const gpu::PassScope scope(commands, "shadow blur");
    constexpr uint32_t kGroups = (kSide * kSide + kTilePixels - 1) / kTilePixels;
    for (uint32_t view = 0; view < shadows.maps_.size(); view++) {
        gpu::dispatch(commands, shadows.along_rows_, shadows.rows_set_, kGroups, ShadowBlurPush{view, 0});
        gpu::compute_barrier(commands);
        gpu::dispatch(commands, shadows.along_columns_, shadows.columns_set_, kGroups,
                      ShadowBlurPush{view, shadows.maps_[view] * kSide * kSide});
        gpu::compute_barrier(commands);
    }
}

}  // namespace neuvv::render
