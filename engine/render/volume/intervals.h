// Intervals: samples of overlapping instances, which are stored along rays and merged in depth order (exact blending).
#pragma once

#include "render/rays/ray_target.h"
#include "render/volume/trace.h"
#include "shared/intervals.h"

#include <algorithm>
#include <array>

namespace neuvv::render {

// The memory of intervals, and the merges of a frame's groups of instances, one after the other. The number of
// intervals is known only after the frame is drawn. Where a device cannot hold all of them, the tiles are divided into
// bands, which are traced and merged one after the other.
class Intervals {
  public:
    // `merges`: the largest number of merges in a frame. `budget`: the largest number of bytes of intervals in a merge;
    // the device's limits may allow fewer.
    Intervals(const gpu::Device& device, const RayTarget& target, uint32_t merges, uint64_t budget);

    // Whether the frame of this slot, which must be finished, had more intervals than there was room for. Then
    // enlarge() makes more room or more bands, and the frame must be recorded again, by passes that are bound to the
    // new buffers. No frame may be under way. enlarge() throws RuntimeFailure where even the smallest bands have more
    // intervals than fit.
    bool overflowed(uint32_t slot) const;
    void enlarge();

    // To be called before a frame is recorded, with its slot.
    void begin_frame(uint32_t slot) {
        slot_ = slot;
        recorded_[slot] = 0;
    }

    // Returns the number of the next merge of the frame. The constructor's `merges` must not be exceeded (assert).
    uint32_t add_merge();

    const gpu::Buffer& pages() const { return pages_; }
    // How many pages there are, those of `heads` included (shared/intervals.h), and how many these are.
    uint64_t page_count() const { return page_count_; }
    uint32_t head_pages() const { return static_cast<uint32_t>(head_pages_); }
    const gpu::Buffer& used_pages() const { return used_pages_[slot_]; }  // of the frame that begin_frame began
    const gpu::ComputePass& pass() const { return pass_; }
    const gpu::BindingSet& bindings() const { return set_; }

    // The number of bands into which the tiles are divided in a frame with this many merged groups.
    uint32_t bands(uint32_t groups) const { return std::min(bands_, std::max(1u, merges_ / std::max(groups, 1u))); }

  private:
    void make_pages(uint64_t pages);
    bool make_more_pages();
    const gpu::Device& device_;
    const RayTarget& target_;
    uint32_t merges_, bands_ = 1;
    uint64_t head_pages_, page_count_ = 0, max_pages_;
    gpu::Buffer pages_;
    uint32_t slot_ = 0;
    std::array<gpu::Buffer, kImagesUnderWay> used_pages_;  // by slot: the pages that each merge needed; readback
    std::array<uint32_t, kImagesUnderWay> recorded_{};     // by slot: merges
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
};

// No ray has intervals any more. A merge leaves it so.
void record_heads_cleared(gpu::Commands& commands, const Intervals& intervals);
// To be recorded before the first instance of a group: all pages are free.
void record_merge_begin(gpu::Commands& commands, const Intervals& intervals);
// To be recorded after the last instance of a group: blends its intervals and composites them under what nearer groups
// left in the target.
void record_merge(gpu::Commands& commands, Intervals& intervals, const TileSpan& tiles, float stop);

}  // namespace neuvv::render
