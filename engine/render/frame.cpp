#include "render/frame.h"

#include <algorithm>

namespace neuvv::render {

// Cameras, tiles and instances are in their buffers, the mode's path is made.
void record_frame(gpu::Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    const uint32_t tiles = r.layout_.ray_tiles();
    const float frame = settings.instances.empty() ? 0 : settings.instances[0].frame;  // a reference has only this one
    switch (settings.mode) {
        case TraceMode::kPlay:
        case TraceMode::kShaded:
        case TraceMode::kTree:
            if (is_inspection(settings.resolve.show))
                record_inspected(commands, r, settings);
            else
                record_playing(commands, r, settings);
            break;
        case TraceMode::kSlice:
            record_slice(commands, r.slots_->slicer, frame);
            record_trace(commands, r.slots_->tracer, tiles, settings.stop);
            break;
        case TraceMode::kDirect:
        case TraceMode::kPaper:
            record_rows(commands, r.direct_->finder, frame);
            record_direct(commands, settings.mode == TraceMode::kPaper ? r.direct_->paper : r.direct_->direct, tiles,
                          settings.stop);
            break;
    }
    if (is_reference(settings.mode)) record_resolve(commands, r.resolver_, r.layout_, settings.resolve);
    gpu::host_barrier(commands);  // it looks at what had no room
}

void record_readback(gpu::Commands& commands, FrameRenderer& r) {
    const gpu::PassScope scope(commands, "readback");
    gpu::copy(commands, r.picture_, r.readback_, r.layout_.picture_bytes());
    gpu::host_barrier(commands);
}

// Slices; on a set what lights see of both, and the set as far as it ends rays; the rays; what is blended before and
// behind them. Without a set only the tiles of the picture that see anything are worked on.
void record_playing(gpu::Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    if (!r.set_) record_blank(commands, r, settings);
    for (const auto& performer : r.performers_) record_slices(commands, *performer);
    if (r.set_) {
        record_performer_shadows(commands, *r.shadows_, r.performers_, kLightTarget);
        record_set_shadows(commands, *r.set_);
        record_set(commands, *r.set_, r.set_cameras_);
    }
    record_rays(commands, r, settings);
    if (r.set_ && r.set_->has_transparent()) {
        record_volume_depth(commands, *r.volume_depth_, r.layout_);
        record_set_transparent(commands, *r.set_, r.set_cameras_);
    }
    if (!r.set_) record_listed(commands, r);
    const Resolver& whole = r.set_ ? r.resolver_ : r.listed_resolver_;
    record_resolve(commands, r.layout_.upscaled() ? *r.upscaler_ : whole, r.layout_, settings.resolve);
    for (const auto& performer : r.performers_) record_slices_ahead(commands, *performer, settings.parts_ahead);
}

// What walks are like in place of what they see. The set takes no part.
void record_inspected(gpu::Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    for (const auto& performer : r.performers_) record_slices(commands, *performer);
    record_rays(commands, r, settings);
    record_inspect(commands, *r.inspector_, r.layout_, settings.resolve);
    for (const auto& performer : r.performers_) record_slices_ahead(commands, *performer, settings.parts_ahead);
}

// What pictures of this layout show where nothing is seen, where they were others so far.
void record_blank(gpu::Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    ViewLayout all_pixels = r.layout_;
    all_pixels.rays = {};
    const std::pair shown(all_pixels, settings.resolve);
    if (r.blank_is_of_ == shown) return;
    record_clear(commands, r.target_.rays, all_pixels.ray_tiles());
    record_resolve(commands, r.resolver_, all_pixels, settings.resolve);
    gpu::copy(commands, r.picture_, r.blank_, r.layout_.picture_bytes());
    r.blank_is_of_ = shown;
}

// The tiles where anything may be seen, in a picture that shows nothing yet.
void record_listed(gpu::Commands& commands, FrameRenderer& r) {
    record_picture_list(commands, r.lister_, r.layout_);
    const gpu::PassScope scope(commands, "blank");
    gpu::copy(commands, r.blank_, r.picture_, r.layout_.picture_bytes());
    gpu::compute_barrier(commands);
}

// The instances, near to far.
void record_rays(gpu::Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    record_clear(commands, r.target_.rays, r.layout_.ray_tiles());
    record_unseen(commands, r.target_.ranges);
    for (const std::vector<DrawnInstance>& group : r.drawn_)
        if (group.size() == 1)
            record_instance(commands, *r.performers_[group[0].field], kEyeTarget, group[0], r.layout_);
        else
            record_merged(commands, r, group, settings);
}

// Instances that have no order: their segments, merged, go under what stands there.
void record_merged(gpu::Commands& commands, FrameRenderer& r, std::span<const DrawnInstance> group,
                   const FrameSettings& settings) {
    record_unshared(commands, r.target_.ranges);
    for (const DrawnInstance& instance : group)
        record_sharing(commands, *r.performers_[instance.field], kEyeTarget, instance, r.layout_);
    const auto groups = static_cast<uint32_t>(
        std::count_if(r.drawn_.begin(), r.drawn_.end(), [](const auto& drawn) { return drawn.size() > 1; }));
    const uint64_t bands = r.segments_->bands(groups), all = r.layout_.ray_tiles();
    for (uint64_t band = 0; band < bands; band++) {
        const TileSpan tiles{static_cast<uint32_t>(all * band / bands),
                             static_cast<uint32_t>(all * (band + 1) / bands)};
        if (tiles.first == tiles.end) continue;
        record_merge_begin(commands, *r.segments_);
        for (DrawnInstance instance : group) {
            instance.rays.tiles = tiles;
            record_instance(commands, *r.performers_[instance.field], kEyeTarget, instance, r.layout_);
        }
        record_merge(commands, *r.segments_, tiles, settings.stop);
    }
}

}  // namespace neuvv::render
