#include "render/frame/frame_intervals.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "gpu/host_copies.h"

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

// What a band is traced with.
struct Bands {
    const gpu::Device& device;
    FrameRecorder& recorder;
    Intervals& intervals;
    const ViewLayout& layout;
    std::span<const std::unique_ptr<Performer>> performers;
    const std::vector<DrawnInstance>& instances;
    const gpu::Buffer& heads;  // readback: the first page of each ray
};

// Traces the instances in these tiles, each as if it shared all of them with another. Leaves the number of pages that
// are in use after each in Intervals::used_pages, and the first page of each ray in `heads`.
void record_band(gpu::Commands& commands, const Bands& bands, const TileSpan& tiles) {
    Intervals& intervals = bands.intervals;
    record_clear_rays(commands, bands.recorder.clearer());
    record_heads_cleared(commands, intervals);
    record_merge_begin(commands, intervals);
    gpu::fill(commands, bands.recorder.target().ranges.sharing, 2);
    gpu::compute_barrier(commands);
    for (size_t i = 0; i < bands.instances.size(); ++i) {
        DrawnInstance instance = bands.instances[i];
        instance.rays.tiles = tiles;
        record_instance(commands, *bands.performers[instance.field], kEyeTarget, instance, bands.layout);
        gpu::copy(commands, intervals.pages(), intervals.used_pages(), sizeof(uint32_t), 0, sizeof(uint32_t) * i);
    }
    gpu::copy(commands, intervals.pages(), bands.heads, sizeof(uint32_t) * kTilePixels * (tiles.end - tiles.first),
              sizeof(uint32_t) * (kFirstHead + uint64_t{kTilePixels} * tiles.first));
    gpu::compute_barrier(commands);
    record_heads_cleared(commands, intervals);  // as later merges expect it
    gpu::host_barrier(commands);
}

// Reads on the host what merge.comp reads.
void take_band(const Bands& bands, const TileSpan& tiles, const TakeIntervals& take) {
    const std::span pages_after(bands.intervals.used_pages().as<uint32_t>(), bands.instances.size());
    std::vector<uint32_t> performers;
    for (const DrawnInstance& instance : bands.instances) performers.push_back(instance.performer);
    std::vector<glm::uvec4> texels((pages_after.back() + size_t{1}) * kPageWords);
    gpu::download(bands.device, bands.intervals.pages(), texels.data(), texels.size() * sizeof(texels[0]));
    std::vector<RayInterval> intervals;
    const uint32_t across = bands.layout.tiles_across();
    for (uint32_t tile = tiles.first; tile < tiles.end; ++tile)
        for (uint32_t i = 0; i < kTilePixels; ++i) {
            const uint32_t first = bands.heads.as<uint32_t>()[size_t{tile - tiles.first} * kTilePixels + i];
            if (first == 0) continue;
            intervals.clear();
            read_intervals({texels, pages_after, performers}, first, intervals);
            const glm::uvec2 corner = kTile * glm::uvec2(tile % across, tile / across);
            take(corner + glm::uvec2(i % kTile, i / kTile), intervals);
        }
}

}  // namespace

void read_frame_intervals(const gpu::Device& device, FrameQueue& queue, FrameRecorder& recorder, const FramePlan& plan,
                          std::span<const std::unique_ptr<Performer>> performers, const TakeIntervals& take) {
    const ViewLayout& layout = plan.layout;
    assert(layout.views == 1 && !layout.upscaled() && "the rays of one whole image");
    const std::vector<DrawnInstance> instances = all_in_intervals(plan.drawn);
    if (instances.empty()) return;
    Intervals& intervals = recorder.intervals();
    for (const DrawnInstance& instance : instances)
        performers[instance.field]->prepare(kEyeTarget, instance, &intervals);
    const gpu::Buffer heads(device, "heads readback", sizeof(uint32_t) * kTilePixels * kMostTiles,
                            gpu::MemoryKind::kReadback);
    const Bands bands{device, recorder, intervals, layout, performers, instances, heads};
    uint32_t most = kMostTiles;
    for (TileSpan band{0, 0}; band.first < layout.ray_tiles();) {
        band.end = std::min(layout.ray_tiles(), band.first + most);
        queue.run([&](gpu::Commands& commands) { record_band(commands, bands, band); });
        const uint32_t used = intervals.used_pages().as<uint32_t>()[instances.size() - 1];
        if (used >= intervals.page_count()) {
            if (most == 1)
                throw RuntimeFailure("performers take more memory along these rays than the device has",
                                     Remedy::kSmallerImage);
            most /= 2;
            continue;
        }
        take_band(bands, band, take);
        band.first = band.end;
        if (used < intervals.page_count() / 3) most = std::min(kMostTiles, 2 * most);
    }
}

}  // namespace neuvv::render
