#include "render/volume/intervals.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/error.h"
#include "spirv/merge.comp.h"

namespace neuvv::render {

namespace {

constexpr uint64_t kPageBytes = 16 * kPageWords;
constexpr uint64_t kFirstPages = (uint64_t{16} << 20) / kPageBytes;

// The pages at the buffer's begin that have no intervals.
uint64_t pages_of_heads(const RayTarget& target) {
    const uint64_t words = kFirstHead + uint64_t{kTilePixels} * target.rays.tile_capacity;
    return (4 * words + kPageBytes - 1) / kPageBytes;
}

// `before` of these are not for intervals.
uint64_t max_pages(const gpu::Device& device, uint64_t before, uint64_t budget) {
    const uint64_t bound = std::min<uint64_t>(device.limits().maxStorageBufferRange, device.max_allocation_bytes());
    const uint64_t bytes = std::min(bound, before * kPageBytes + std::min(budget, bound));
    return std::clamp<uint64_t>(bytes / kPageBytes, before + 1, UINT32_MAX / kPageWords);
}

}  // namespace

Intervals::Intervals(const gpu::Device& device, const RayTarget& target, uint32_t merges, uint64_t budget)
    : device_(device),
      target_(target),
      merges_(merges),
      head_pages_(pages_of_heads(target)),
      max_pages_(max_pages(device, head_pages_, budget)),
      pass_(device, "merge", device.buffers().fitting(merge_comp, merge_comp_storage)) {
    for (gpu::Buffer& used : used_pages_)
        used = gpu::Buffer(device, "used pages", uint64_t{4} * merges, gpu::MemoryKind::kReadback);
    make_pages(std::min(head_pages_ + kFirstPages, max_pages_));
}

void Intervals::make_pages(uint64_t pages) {
    pages_ = gpu::Buffer();  // frees its memory before the new buffer is created
    pages_ = gpu::Buffer(device_, "intervals", kPageBytes * pages, gpu::MemoryKind::kDevice);
    page_count_ = pages;
    set_ = gpu::BindingSet(pass_, {{kMergePages, &pages_},
                                   {kMergeCovered, &target_.ranges.covered},
                                   {kMergeRadiance, &target_.rays.radiance},
                                   {kMergeDepth, &target_.rays.depth}});
    gpu::run_once(device_, "heads of intervals",
                  [this](gpu::Commands& commands) { record_heads_cleared(commands, *this); });
}

// Doubles the number of pages, up to the limit. Returns false where there was no memory for more; then the present
// number is the limit from now on.
bool Intervals::make_more_pages() {
    const uint64_t before = page_count_;
    if (before >= max_pages_) return false;
    try {
        make_pages(std::min(max_pages_, 2 * before));
        return true;
    } catch (const RuntimeFailure&) {  // the limits do not count other allocations
        max_pages_ = before;
        make_pages(before);
        return false;
    }
}

bool Intervals::overflowed(uint32_t slot) const {
    const std::span used(used_pages_[slot].as<uint32_t>(), recorded_[slot]);
    return std::any_of(used.begin(), used.end(), [this](uint32_t pages) { return pages >= page_count_; });
}

void Intervals::enlarge() {
    const uint32_t merges = *std::max_element(recorded_.begin(), recorded_.end());
    recorded_ = {};
    if (make_more_pages()) return;
    if (2 * bands_ > target_.rays.tile_capacity || 2 * merges > merges_)
        throw RuntimeFailure(
            "performers that stand in each other take more memory along these rays than the device has",
            Remedy::kCheaperBlend);
    bands_ *= 2;
}

uint32_t Intervals::add_merge() {
    assert(recorded_[slot_] < merges_ && "more merges a frame than there is room for");
    return recorded_[slot_]++;
}

void record_heads_cleared(gpu::Commands& commands, const Intervals& intervals) {
    gpu::fill(commands, intervals.pages(), 0, kPageBytes * intervals.head_pages());
    gpu::compute_barrier(commands);
}

void record_merge_begin(gpu::Commands& commands, const Intervals& intervals) {
    gpu::update(commands, intervals.pages(), intervals.head_pages() - 1);
    gpu::compute_barrier(commands);
}

void record_merge(gpu::Commands& commands, Intervals& intervals, const TileSpan& tiles, float stop) {
    const gpu::PassScope scope(commands, "merge");
    gpu::copy(commands, intervals.pages(), intervals.used_pages(), 4, 0, uint64_t{4} * intervals.add_merge());
    gpu::compute_barrier(commands);
    if (tiles.end > tiles.first)
        gpu::dispatch_groups(commands, intervals.pass(), intervals.bindings(), tiles.end - tiles.first,
                             MergePush{stop, tiles.first, tiles.end});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
