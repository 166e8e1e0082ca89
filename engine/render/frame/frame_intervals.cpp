// FrameRenderer::read_intervals: traces the rays of the last image once more, band by band, as instances that are
// merged are traced, and reads on the host what merge.comp reads.
#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "gpu/host_copies.h"
#include "render/frame/frame.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kMostTiles = 4096;  // of a band

std::vector<DrawnInstance> all_in_intervals(std::span<const std::vector<DrawnInstance>> groups) {
    std::vector<DrawnInstance> instances;
    for (const std::vector<DrawnInstance>& group : groups)
        for (DrawnInstance instance : group) {
            instance.output = RayOutput::kIntervals;
            instances.push_back(instance);
        }
    return instances;
}

}  // namespace

// Traces the instances in these tiles, each as if it shared all of them with another. Leaves the number of pages that
// are in use after each in Intervals::used_pages, and the first page of each ray in `heads`.
void FrameRenderer::record_intervals(std::span<const DrawnInstance> instances, const TileSpan& tiles,
                                     const gpu::Buffer& heads) {
    record_clear_rays(commands(), clearer_);
    record_heads_cleared(commands(), *intervals_);
    record_merge_begin(commands(), *intervals_);
    gpu::fill(commands(), target_.ranges.sharing, 2);
    gpu::compute_barrier(commands());
    for (size_t i = 0; i < instances.size(); ++i) {
        DrawnInstance instance = instances[i];
        instance.rays.tiles = tiles;
        record_instance(commands(), *slices_.performers()[instance.field], kEyeTarget, instance, layout_);
        gpu::copy(commands(), intervals_->pages(), intervals_->used_pages(), sizeof(uint32_t), 0, sizeof(uint32_t) * i);
    }
    gpu::copy(commands(), intervals_->pages(), heads, sizeof(uint32_t) * kTilePixels * (tiles.end - tiles.first),
              sizeof(uint32_t) * (kFirstHead + uint64_t{kTilePixels} * tiles.first));
    gpu::compute_barrier(commands());
    record_heads_cleared(commands(), *intervals_);  // as later merges expect it
    gpu::host_barrier(commands());
}

void FrameRenderer::take_band(std::span<const DrawnInstance> instances, const TileSpan& tiles, const gpu::Buffer& heads,
                              const TakeIntervals& take) const {
    const std::span pages_after(intervals_->used_pages().as<uint32_t>(), instances.size());
    std::vector<uint32_t> performers;
    for (const DrawnInstance& instance : instances) performers.push_back(instance.performer);
    std::vector<glm::uvec4> texels((pages_after.back() + size_t{1}) * kPageWords);
    gpu::download(device_, intervals_->pages(), texels.data(), texels.size() * sizeof(texels[0]));
    std::vector<RayInterval> intervals;
    for (uint32_t tile = tiles.first; tile < tiles.end; ++tile)
        for (uint32_t i = 0; i < kTilePixels; ++i) {
            const uint32_t first = heads.as<uint32_t>()[size_t{tile - tiles.first} * kTilePixels + i];
            if (first == 0) continue;
            intervals.clear();
            render::read_intervals({texels, pages_after, performers}, first, intervals);
            const glm::uvec2 corner = kTile * glm::uvec2(tile % layout_.tiles_across(), tile / layout_.tiles_across());
            take(corner + glm::uvec2(i % kTile, i / kTile), intervals);
        }
}

void FrameRenderer::read_intervals(const TakeIntervals& take) {
    finish();
    assert(layout_.views == 1 && !layout_.upscaled() && "the rays of one whole image");
    const std::vector<DrawnInstance> instances = all_in_intervals(drawn_);
    if (instances.empty()) return;
    for (const DrawnInstance& instance : instances)
        slices_.performers()[instance.field]->prepare(kEyeTarget, instance, &intervals());
    const gpu::Buffer heads(device_, "heads readback", sizeof(uint32_t) * kTilePixels * kMostTiles,
                            gpu::MemoryKind::kReadback);
    uint32_t most = kMostTiles;
    for (TileSpan band{0, 0}; band.first < layout_.ray_tiles();) {
        band.end = std::min(layout_.ray_tiles(), band.first + most);
        queue_.run([&](gpu::Commands&) { record_intervals(instances, band, heads); });
        const uint32_t used = intervals_->used_pages().as<uint32_t>()[instances.size() - 1];
        if (used >= intervals_->page_count()) {
            if (most == 1)
                throw RuntimeFailure("performers take more memory along these rays than the device has",
                                     Remedy::kSmallerImage);
            most /= 2;
            continue;
        }
        take_band(instances, band, heads, take);
        band.first = band.end;
        if (used < intervals_->page_count() / 3) most = std::min(kMostTiles, 2 * most);
    }
}

}  // namespace neuvv::render
