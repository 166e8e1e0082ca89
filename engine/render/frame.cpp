#include "render/frame.h"

#include <algorithm>

namespace neuvv::render {

// Cameras, tiles and instances are in their buffers, the mode's path is made.
void FrameRenderer::record_frame(const FrameSettings& settings) {
    const uint32_t tiles = layout_.ray_tiles();
    const float frame = settings.instances.empty() ? 0 : settings.instances[0].frame;  // a reference has only this one
    switch (settings.mode) {
        case TraceMode::kPlay:
        case TraceMode::kShaded:
        case TraceMode::kTree:
            if (is_inspection(settings.resolve.show))
                record_inspected(settings);
            else
                record_playing(settings);
            break;
        case TraceMode::kSlice:
            record_slice(commands_, slots_->slicer, frame);
            record_trace(commands_, slots_->tracer, tiles, settings.stop);
            break;
        case TraceMode::kDirect:
        case TraceMode::kPaper:
            record_rows(commands_, direct_->finder, frame);
            record_direct(commands_, settings.mode == TraceMode::kPaper ? direct_->paper : direct_->direct, tiles,
                          settings.stop);
            break;
    }
    if (is_reference(settings.mode)) record_resolve(commands_, resolver_, layout_, settings.resolve);
    gpu::host_barrier(commands_);  // it looks at what had no room
}

void FrameRenderer::record_readback() {
    const gpu::PassScope scope(commands_, "readback");
    gpu::copy(commands_, picture_, readback_, layout_.picture_bytes());
    gpu::host_barrier(commands_);
}

// Slices; on a set what lights see of both, and the set as far as it ends rays; the rays; what is blended before and
// behind them. Without a set only the tiles of the picture that see anything are worked on.
void FrameRenderer::record_playing(const FrameSettings& settings) {
    if (!set_) record_blank(settings);
    for (const auto& performer : performers_) record_slices(commands_, *performer);
    if (set_) {
        record_performer_shadows(commands_, *shadows_, performers_, kLightTarget);
        set_->record_shadows(commands_);
        set_->record_solid(commands_, set_cameras_);
    }
    record_rays(settings);
    if (set_ && set_->has_transparent()) {
        record_volume_depth(commands_, *volume_depth_, layout_);
        set_->record_transparent(commands_, set_cameras_);
    }
    if (!set_) record_listed();
    const Resolver& whole = set_ ? resolver_ : listed_resolver_;
    record_resolve(commands_, layout_.upscaled() ? *upscaler_ : whole, layout_, settings.resolve);
    for (const auto& performer : performers_) record_slices_ahead(commands_, *performer, settings.parts_ahead);
}

// What walks are like in place of what they see. The set takes no part.
void FrameRenderer::record_inspected(const FrameSettings& settings) {
    for (const auto& performer : performers_) record_slices(commands_, *performer);
    record_rays(settings);
    record_inspect(commands_, *inspector_, layout_, settings.resolve);
    for (const auto& performer : performers_) record_slices_ahead(commands_, *performer, settings.parts_ahead);
}

// What pictures of this layout show where nothing is seen, where they were others so far.
void FrameRenderer::record_blank(const FrameSettings& settings) {
    ViewLayout all_pixels = layout_;
    all_pixels.rays = {};
    const std::pair shown(all_pixels, settings.resolve);
    if (blank_is_of_ == shown) return;
    record_clear(commands_, target_.rays, all_pixels.ray_tiles());
    record_resolve(commands_, resolver_, all_pixels, settings.resolve);
    gpu::copy(commands_, picture_, blank_, layout_.picture_bytes());
    blank_is_of_ = shown;
}

// The tiles where anything may be seen, in a picture that shows nothing yet.
void FrameRenderer::record_listed() {
    record_picture_list(commands_, lister_, layout_);
    const gpu::PassScope scope(commands_, "blank");
    gpu::copy(commands_, blank_, picture_, layout_.picture_bytes());
    gpu::compute_barrier(commands_);
}

// The instances, near to far.
void FrameRenderer::record_rays(const FrameSettings& settings) {
    record_clear(commands_, target_.rays, layout_.ray_tiles());
    record_unseen(commands_, target_.ranges);
    for (const std::vector<DrawnInstance>& group : drawn_)
        if (group.size() == 1)
            record_instance(commands_, *performers_[group[0].field], kEyeTarget, group[0], layout_);
        else
            record_merged(group, settings);
}

// Instances that have no order: their segments, merged, go under what stands there.
void FrameRenderer::record_merged(std::span<const DrawnInstance> group, const FrameSettings& settings) {
    record_unshared(commands_, target_.ranges);
    for (const DrawnInstance& instance : group)
        record_sharing(commands_, *performers_[instance.field], kEyeTarget, instance, layout_);
    const auto groups = static_cast<uint32_t>(
        std::count_if(drawn_.begin(), drawn_.end(), [](const auto& drawn) { return drawn.size() > 1; }));
    const uint64_t bands = segments_->bands(groups), all = layout_.ray_tiles();
    for (uint64_t band = 0; band < bands; band++) {
        const TileSpan tiles{static_cast<uint32_t>(all * band / bands),
                             static_cast<uint32_t>(all * (band + 1) / bands)};
        if (tiles.first == tiles.end) continue;
        record_merge_begin(commands_, *segments_);
        for (DrawnInstance instance : group) {
            instance.rays.tiles = tiles;
            record_instance(commands_, *performers_[instance.field], kEyeTarget, instance, layout_);
        }
        record_merge(commands_, *segments_, tiles, settings.stop);
    }
}

}  // namespace neuvv::render
