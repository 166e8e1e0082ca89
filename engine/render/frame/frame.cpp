#include "render/frame/frame.h"

#include <algorithm>

namespace neuvv::render {

// The tiles are in their buffer already. What other images read and write comes first.
void FrameRenderer::record_frame(const FrameSettings& settings) {
    gpu::full_barrier(commands());
    record_cameras(commands(), target_);
    if (is_inspection(settings.resolve.show))
        record_inspected(settings);
    else
        record_playing(settings);
    gpu::host_barrier(commands());  // the host reads the counts of what had no room
}

void FrameRenderer::record_readback() {
    const gpu::PassScope scope(commands(), "readback");
    gpu::copy(commands(), image_, readback_, layout_.image_bytes());
    gpu::host_barrier(commands());
}

// Comments say what each pass reads → writes, by the names of buffers in their structs: Field, SliceTrees, TileRanges
// (target_.ranges), RayBatch (target_.rays) and SetRaster. Passes of a slice are recorded in volume/slice_tree.cpp,
// those of one instance in volume/performer.cpp (record_instance). With a set, the shadow maps of performers and set
// follow the slices, and rays end at the set. Without a set, only the tiles of the image that an instance may cover are
// resolved, and those that the last frame's instances may have covered; elsewhere the image stays as it is.
void FrameRenderer::record_playing(const FrameSettings& settings) {
    // Where the layout or the resolve settings are not those of the last image: ranges.covered, rays.cameras →
    // rays.radiance, rays.depth, ranges.covered, ranges.image_shown, image_
    if (!set_) record_blank(settings);
    // Field weights, bases and nodes, Paint → SliceTrees nodes, entries, entry_leaf, counts
    for (const auto& performer : slices_.performers())
        if (performer) record_slices(commands(), *performer);
    if (set_) {
        set_->lighting.record_lights(commands());
        // SliceTrees → the shadows' own ranges and rays → SetRaster performer_shadows
        record_performer_shadows(commands(), *shadows_, slices_.performers(), kLightTarget);
        // SetRaster vertices, materials, lights_buffer → set_shadow_maps
        set_->record_shadows(commands());
        // the same, set_shadow_maps, performer_shadows → colour, depth
        set_->record_solid(commands(), set_cameras_);
    }
    // SliceTrees, rays.cameras, rays.tiles, SetRaster depth and lights → ranges.*, rays.radiance, rays.depth
    record_rays(settings);
    if (set_ && set_->has_transparent()) {
        // rays.radiance, rays.depth, rays.cameras → SetRaster volume_depth
        record_volume_depth(commands(), *volume_depth_, layout_);
        // vertices, materials, lights_buffer, both shadow maps, volume_depth → colour, front
        set_->record_transparent(commands(), set_cameras_);
    }
    // ranges.covered, ranges.image_shown → ranges.image_list, ranges.image_count, ranges.image_shown
    if (!set_) record_image_list(commands(), lister_, layout_);
    // rays.radiance, rays.depth, rays.cameras, ranges.image_list or SetRaster colour, front, depth → image_
    const Resolver& whole = set_ ? resolver_ : listed_resolver_;
    record_resolve(commands(), layout_.upscaled() ? *upscaler_ : whole, layout_, settings.resolve);
    // Field, Paint → SliceTrees of the next frames, in parts; counts → counts_readback_ of the slot
    for (const auto& performer : slices_.performers())
        if (performer) record_prefetch(commands(), *performer, settings.prefetch_parts, queue_.slot());
}

// An inspection shows the walks of rays in place of light, and leaves out the set.
void FrameRenderer::record_inspected(const FrameSettings& settings) {
    blank_key_.reset();  // as it draws all of image_
    for (const auto& performer : slices_.performers())
        if (performer) record_slices(commands(), *performer);
    record_rays(settings);
    record_inspect(commands(), *inspector_, layout_, settings.resolve);
    for (const auto& performer : slices_.performers())
        if (performer) record_prefetch(commands(), *performer, settings.prefetch_parts, queue_.slot());
}

// Draws an image without instances, unless image_ is one already but for the tiles that are marked as shown.
void FrameRenderer::record_blank(const FrameSettings& settings) {
    ViewLayout all_pixels = layout_;
    all_pixels.rays = {};
    const std::pair shown(all_pixels, settings.resolve);
    if (blank_key_ == shown) return;
    record_clear_rays(commands(), clearer_);
    record_resolve(commands(), resolver_, all_pixels, settings.resolve);
    gpu::fill(commands(), target_.ranges.image_shown, 0);
    gpu::compute_barrier(commands());
    blank_key_ = shown;
}

// Traces the instances, near to far.
void FrameRenderer::record_rays(const FrameSettings& settings) {
    record_clear_rays(commands(), clearer_);
    for (const std::vector<DrawnInstance>& group : drawn_)
        if (group.size() == 1)
            record_instance(commands(), *slices_.performers()[group[0].field], kEyeTarget, group[0], layout_);
        else
            record_merged(group, settings);
}

// Traces instances that have no order: their intervals are merged and composited under what nearer groups left.
void FrameRenderer::record_merged(std::span<const DrawnInstance> group, const FrameSettings& settings) {
    record_clear_sharing(commands(), target_.ranges);
    for (const DrawnInstance& instance : group)
        record_sharing(commands(), *slices_.performers()[instance.field], kEyeTarget, instance, layout_);
    const auto groups = static_cast<uint32_t>(
        std::count_if(drawn_.begin(), drawn_.end(), [](const auto& drawn) { return drawn.size() > 1; }));
    const uint64_t bands = intervals_->bands(groups), all = layout_.ray_tiles();
    for (uint64_t band = 0; band < bands; ++band) {
        const TileSpan tiles{static_cast<uint32_t>(all * band / bands),
                             static_cast<uint32_t>(all * (band + 1) / bands)};
        if (tiles.first == tiles.end) continue;
        record_merge_begin(commands(), *intervals_);
        for (DrawnInstance instance : group) {
            instance.rays.tiles = tiles;
            record_instance(commands(), *slices_.performers()[instance.field], kEyeTarget, instance, layout_);
        }
        record_merge(commands(), *intervals_, tiles, settings.stop);
    }
}

}  // namespace neuvv::render
