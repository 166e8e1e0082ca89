// Segments: what instances that stand in each other put along rays, and its merge in depth order (exact blending).
#pragma once

#include "render/ray_target.h"
#include "shared/segments.h"

#include <algorithm>

namespace neuvv::render {

// Room for segments, and the merge of one frame's groups of instances, each after the other. How many there are is
// known only after the frame, so its rays go in bands where a device cannot hold all at once.
class Segments {
  public:
    // At most so many merges a frame, and bytes of segments in each, or as many as the device has.
    Segments(const gpu::Device& device, const RayTarget& target, uint32_t merges, uint64_t budget);

    // After a frame was waited for, whether there was less room than segments. Then enlarge() makes more room, or more
    // bands, and the frame must be recorded anew, by passes that are bound to the new buffers. It throws RuntimeFailure
    // where even a tile has more segments than fit.
    bool overflowed() const;
    void enlarge();

    // Before a frame is recorded.
    void begin_frame() { recorded_ = 0; }

    // One more merge of the frame is recorded: its number. There is room for as many as the constructor was told.
    uint32_t add_merge();

    const gpu::Buffer& pages() const { return pages_; }
    const gpu::Buffer& heads() const { return heads_; }
    const gpu::Buffer& used_pages() const { return used_pages_; }
    const gpu::ComputePass& pass() const { return pass_; }
    const gpu::BindingSet& bindings() const { return set_; }

    // Parts of the tiles that each of so many merged groups of a frame goes over.
    uint32_t bands(uint32_t groups) const { return std::min(bands_, std::max(1u, merges_ / std::max(groups, 1u))); }

  private:
    void make_pages(uint64_t pages);
    bool make_more_pages();
    const gpu::Device& device_;
    const RayTarget& target_;
    uint32_t merges_, bands_ = 1;
    uint64_t page_count_ = 0, max_pages_;
    gpu::Buffer pages_, heads_;
    gpu::Buffer used_pages_;  // pages of each merge of the frame, readback
    uint32_t recorded_ = 0;
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
};

// Before the first instance of a group: no page is taken.
void record_merge_begin(gpu::Commands& commands, const Segments& segments);
// After the last: the group goes under what nearer ones left in the target.
void record_merge(gpu::Commands& commands, Segments& segments, const TileSpan& tiles, float stop);

}  // namespace neuvv::render
