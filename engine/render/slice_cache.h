// Slices of one field that are kept on the device: those shown last, as many as a budget holds.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>

#include "render/slice_tree.h"

namespace neuvv::render {

// Bytes that the slices of a performer may take on the device, however many instances and frames are shown.
constexpr uint64_t kSliceBudget = uint64_t{256} << 20;

// What a slice shows: a time of the clip, and how it is painted (Paints; 0: not at all).
struct SliceKey {
    float frame = 0;
    uint32_t paint = 0;
    bool operator==(const SliceKey&) const = default;
};

class SliceCache {
  public:
    // Room for as many slices of `entries` entries as the budget allows, one at least. `live` is scratch. All must
    // outlive it; the paints may become more and fewer.
    SliceCache(const gpu::Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
               uint32_t entries, uint64_t budget_bytes);

    // Before an image: it needs these slices. Those that are kept stay; the others take the places of those that were
    // not asked for for longest, the painted first, the first of them first, until all places are this image's. Where
    // the painted do not all find one, some share one of the places, and are built there while the image is drawn
    // (record_slice_of). Throws RuntimeFailure for a paint that is not there.
    void request(std::span<const SliceKey> keys);
    // Where a slice that was asked for is; none where there was no room.
    std::optional<uint32_t> find(SliceKey key) const;
    // Whether the image that asked last shows it.
    bool is_used(uint32_t slice) const { return slices_[slice].key && slices_[slice].last_used == images_; }
    void forget();

    // After ask(): these slices will be needed next. The first of them that is not kept is built in parts
    // (record_ahead), in the place of one that this image does not need, if there is any.
    void request_prefetch(std::span<const SliceKey> keys);

    // Builds the slices that were asked for and are not there, but for those that share a place.
    void record_slices(gpu::Commands& commands);
    // Where a slice that was asked for is; one that shares its place is built there, and stays until the next of them
    // is. None where there was no room for one without paint.
    std::optional<uint32_t> find_or_record(gpu::Commands& commands, SliceKey key);
    // Builds so many parts of those that were asked for ahead.
    void record_prefetch(gpu::Commands& commands, uint32_t parts);

    const SliceTrees& trees() const { return trees_; }

  private:
    struct CachedSlice {
        std::optional<SliceKey> key;
        uint32_t parts = 0;           // of kSliceParts that are built
        uint64_t last_used = 0;       // by which image last
        uint64_t last_requested = 0;  // the same, or ahead of one
    };
    CachedSlice* find_cached(SliceKey key);
    CachedSlice& oldest();
    CachedSlice* replaceable_for(SliceKey key);
    void choose_shared();
    void bind(std::span<const SliceKey> keys);
    const SlicePaint* paint_of(SliceKey key) const;
    void build(gpu::Commands& commands, uint32_t slice, uint32_t parts);
    const gpu::Device& device_;
    const Field& field_;
    const LiveLeaves& live_;
    const Paints& paints_;
    SliceTrees trees_;
    TreeSlicer slicer_;
    std::vector<CachedSlice> slices_;  // per slice; of one at most a part is built, which then has the live leaves
    std::optional<uint32_t> shared_;   // the place that painted slices share in this image
    std::vector<SliceKey> prefetch_;
    uint64_t images_ = 0;
    std::unique_ptr<Painter> painter_;  // made when first needed
    std::map<uint32_t, SlicePaint> bound_;
};

}  // namespace neuvv::render
