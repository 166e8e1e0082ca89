#include "render/frame/frame_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "base/error.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kMaxMerges = 4 * kMaxInstances;  // groups of instances, times bands

ViewLayout largest(const FrameCapacity& capacity) {
    return {capacity.width, capacity.height, capacity.samples, capacity.views};
}

const SetTargets* targets_of(const SetRaster* set) {
    return set ? &set->targets() : nullptr;
}

SetBuffers set_buffers_of(const SetRaster* set) {
    if (!set) return {};
    const SetLighting& lighting = set->lighting;
    return {&set->targets().depth, &lighting.lights_buffer, &lighting.set_shadow_maps, &lighting.performer_shadows};
}

}  // namespace

FrameRecorder::FrameRecorder(const gpu::Device& device, const FrameCapacity& capacity, SetRaster* set)
    : device_(device),
      views_(capacity.views),
      interval_budget_(capacity.interval_budget),
      set_(set),
      target_(device, capacity.views * (kMaxInstances + 1), checked_ray_tiles(device, largest(capacity)),
              largest(capacity).image_tiles(), set_buffers_of(set)),
      image_(device, "image", largest(capacity).image_bytes(), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "image readback", largest(capacity).image_bytes(), gpu::MemoryKind::kReadback),
      clearer_(device, target_),
      lister_(device, target_.rays, target_.ranges),
      resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, nullptr, targets_of(set)),
      listed_resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, &target_.ranges) {
    if (!set) return;
    assert(set->targets().views() >= capacity.views);
    shadows_ = std::make_unique<PerformerShadows>(device, set->lighting, kMaxInstances);
    volume_depth_ = std::make_unique<VolumeDepth>(device, target_.rays, set->targets());
}

void FrameRecorder::expect_room(const ViewLayout& layout) const {
    if (layout.ray_tiles() > target_.rays.tile_capacity || layout.views > views_ ||
        layout.image_tiles() > target_.ranges.image_tile_capacity || layout.image_bytes() > readback_.bytes)
        throw RuntimeFailure(fmt::format("{} images of {}x{} are more than their renderer was made for", layout.views,
                                         layout.width, layout.height));
    if (set_ && (layout.samples * layout.width > set_->targets().width ||
                 layout.samples * layout.height > set_->targets().height))
        throw RuntimeFailure(fmt::format("{}x{} pixels of {} rays are more than the set's {}x{} texels", layout.width,
                                         layout.height, layout.samples * layout.samples, set_->targets().width,
                                         set_->targets().height));
}

std::vector<PerformerTarget> FrameRecorder::performer_targets() const {
    std::vector<PerformerTarget> targets{{&target_, views_}};
    if (shadows_) targets.push_back({&shadows_->target, kMaxShadows});
    return targets;
}

void FrameRecorder::make_upscaler() {
    if (!upscaler_)
        upscaler_ = std::make_unique<Resolver>(device_, RaysPerPixel::kFewer, target_.rays, image_,
                                               set_ ? nullptr : &target_.ranges, targets_of(set_));
}

std::span<const DrawnInstance> FrameRecorder::plan_shadows(const FieldLevels& levels,
                                                           std::span<const Instance> instances) {
    if (!shadows_) return {};
    shadows_->prepare(levels, instances);
    return shadows_->drawn;
}

void FrameRecorder::make_passes(const FramePlan& plan, const FrameSettings& settings, const SliceResidency& slices) {
    if (is_inspection(settings.resolve.show) && !inspector_)
        inspector_ = std::make_unique<Inspector>(device_, target_.rays, image_, slices.fields());
    if (shadows_)
        for (const DrawnInstance& instance : shadows_->drawn)
            slices.performers()[instance.field]->prepare(kLightTarget, instance, nullptr);
    for (const auto& group : plan.drawn) {
        if (group.size() > 1) intervals();
        for (const DrawnInstance& instance : group)
            slices.performers()[instance.field]->prepare(kEyeTarget, instance, intervals_.get());
    }
}

Intervals& FrameRecorder::intervals() {
    if (!intervals_) intervals_ = std::make_unique<Intervals>(device_, target_, kMaxMerges, interval_budget_);
    return *intervals_;
}

void FrameRecorder::begin_intervals(uint32_t slot) {
    if (intervals_) intervals_->begin_frame(slot);
}

void FrameRecorder::enlarge_intervals(std::span<const std::unique_ptr<Performer>> performers) {
    bool any = false;
    for (uint32_t slot = 0; slot < kImagesUnderWay; ++slot) any |= intervals_overflowed(slot);
    if (!any) return;
    for (const auto& performer : performers)
        if (performer) performer->forget_intervals();
    intervals_->enlarge();
}

// The tiles are in their buffer already. What other images read and write comes first.
void FrameRecorder::record_frame(const FrameParts& frame) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    gpu::full_barrier(commands);
    record_cameras(commands, target_);
    if (is_inspection(settings.resolve.show))
        record_inspected(frame);
    else
        record_playing(frame);
    gpu::host_barrier(commands);  // the host reads the counts of what had no room
}

void FrameRecorder::record_readback(gpu::Commands& commands, const ViewLayout& layout) {
    const gpu::PassScope scope(commands, "readback");
    gpu::copy(commands, image_, readback_, layout.image_bytes());
    gpu::host_barrier(commands);
}

// Comments say what each pass reads → writes, by the names of buffers in their structs: Field, SliceTrees, TileRanges
// (target_.ranges), RayBatch (target_.rays), SetTargets, SetMeshes and SetLighting. Passes of a slice are recorded in
// volume/slices/slice_tree.cpp, those of one instance in volume/performer.cpp (record_instance). With a set, the shadow
// maps of performers and set follow the slices, and rays end at the set. Without a set, only the tiles of the image
// that an instance may cover are resolved, and those that the last frame's instances may have covered; elsewhere the
// image stays as it is.
void FrameRecorder::record_playing(const FrameParts& frame) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    // Where the layout or the resolve settings are not those of the last image: ranges.covered, rays.cameras →
    // rays.radiance, rays.depth, ranges.covered, ranges.image_shown, image_
    if (!set_) record_blank(frame);
    // Field weights, bases and nodes, Paint → SliceTrees nodes, entries, entry_leaf, counts
    for (const auto& performer : performers)
        if (performer) record_slices(commands, *performer);
    if (set_) {
        set_->lighting.record_lights(commands);
        // SliceTrees → the shadows' own ranges and rays → SetLighting performer_shadows
        record_performer_shadows(commands, *shadows_, performers, kLightTarget);
        // SetMeshes vertices, materials, SetLighting lights_buffer → set_shadow_maps
        set_->record_shadows(commands);
        // the same, set_shadow_maps, performer_shadows → SetTargets colour, depth
        set_->record_solid(commands, plan.set_cameras);
    }
    // SliceTrees, rays.cameras, rays.tiles, SetTargets depth, SetLighting lights_buffer → ranges.*, rays.radiance,
    // rays.depth
    record_rays(frame);
    if (set_ && set_->has_transparent()) {
        // rays.radiance, rays.depth, rays.cameras → SetTargets volume_depth
        record_volume_depth(commands, *volume_depth_, plan.layout);
        // vertices, materials, lights_buffer, both shadow maps, volume_depth → SetTargets colour, front
        set_->record_transparent(commands, plan.set_cameras);
    }
    // ranges.covered, ranges.image_shown → ranges.image_list, ranges.image_count, ranges.image_shown
    if (!set_) record_image_list(commands, lister_, plan.layout);
    // rays.radiance, rays.depth, rays.cameras, ranges.image_list or SetTargets colour, front, depth → image_
    const Resolver& whole = set_ ? resolver_ : listed_resolver_;
    record_resolve(commands, plan.layout.upscaled() ? *upscaler_ : whole, plan.layout, settings.resolve);
    // Field, Paint → SliceTrees of the next frames, in parts; counts → counts_readback_ of the slot
    for (const auto& performer : performers)
        if (performer) record_prefetch(commands, *performer, settings.prefetch_parts, slot);
}

// An inspection shows the walks of rays in place of light, and leaves out the set.
void FrameRecorder::record_inspected(const FrameParts& frame) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    blank_key_.reset();  // as it draws all of image_
    for (const auto& performer : performers)
        if (performer) record_slices(commands, *performer);
    record_rays(frame);
    record_inspect(commands, *inspector_, plan.layout, settings.resolve);
    for (const auto& performer : performers)
        if (performer) record_prefetch(commands, *performer, settings.prefetch_parts, slot);
}

// Draws an image without instances, unless image_ is one already but for the tiles that are marked as shown.
void FrameRecorder::record_blank(const FrameParts& frame) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    ViewLayout all_pixels = plan.layout;
    all_pixels.rays = {};
    const std::pair shown(all_pixels, settings.resolve);
    if (blank_key_ == shown) return;
    record_clear_rays(commands, clearer_);
    record_resolve(commands, resolver_, all_pixels, settings.resolve);
    gpu::fill(commands, target_.ranges.image_shown, 0);
    gpu::compute_barrier(commands);
    blank_key_ = shown;
}

// Traces the instances, near to far.
void FrameRecorder::record_rays(const FrameParts& frame) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    record_clear_rays(commands, clearer_);
    for (const std::vector<DrawnInstance>& group : plan.drawn)
        if (group.size() == 1)
            record_instance(commands, *performers[group[0].field], kEyeTarget, group[0], plan.layout);
        else
            record_merged(frame, group);
}

// Traces instances that have no order: their intervals are merged and composited under what nearer groups left.
void FrameRecorder::record_merged(const FrameParts& frame, std::span<const DrawnInstance> group) {
    const auto& [commands, slot, plan, settings, performers] = frame;
    record_clear_sharing(commands, target_.ranges);
    for (const DrawnInstance& instance : group)
        record_sharing(commands, *performers[instance.field], kEyeTarget, instance, plan.layout);
    const auto groups = static_cast<uint32_t>(
        std::count_if(plan.drawn.begin(), plan.drawn.end(), [](const auto& drawn) { return drawn.size() > 1; }));
    const uint64_t bands = intervals_->bands(groups), all = plan.layout.ray_tiles();
    for (uint64_t band = 0; band < bands; ++band) {
        const TileSpan tiles{static_cast<uint32_t>(all * band / bands),
                             static_cast<uint32_t>(all * (band + 1) / bands)};
        if (tiles.first == tiles.end) continue;
        record_merge_begin(commands, *intervals_);
        for (DrawnInstance instance : group) {
            instance.rays.tiles = tiles;
            record_instance(commands, *performers[instance.field], kEyeTarget, instance, plan.layout);
        }
        record_merge(commands, *intervals_, tiles, settings.stop);
    }
}

}  // namespace neuvv::render
