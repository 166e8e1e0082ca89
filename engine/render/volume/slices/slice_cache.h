// Slices of one field that are kept on the device: those that images used last, as many as a budget allows.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>

#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// The default budget: bytes that slices may take on the device, however many instances and times there are.
constexpr uint64_t kSliceBudget = uint64_t{256} << 20;

// What slices may take of a device with this memory, where `wanted` bytes are asked for: at most half of what the
// process may still take, as clips, images and other passes need memory, too; of a device that does not tell how much
// that is, at most an eighth. But never 0, which would mean no slices, unless that is wanted.
uint64_t slice_budget(const gpu::HeapMemory& memory, uint64_t wanted);

// The content of a slice: a time of the clip in frames, and a paint (its number in Paints; 0: none).
struct SliceKey {
    float frame = 0;
    uint32_t paint = 0;
    bool operator==(const SliceKey&) const = default;
};

class SliceCache {
  public:
    // Has room for as many slices of `entries` entries as the budget, the clip and the device allow, but at least for
    // one. `live` is scratch memory. All arguments must outlive it; paints may be added and removed meanwhile.
    SliceCache(const gpu::Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
               uint32_t entries, uint64_t budget_bytes);
    // Of a field that came with its only slice (Field::slice), which is always there and takes no memory here.
    SliceCache(const gpu::Device& device, const Field& field, const Paints& paints);

    // Requests the slices that an image needs, before the image is recorded. Cached slices stay. Each of the others
    // replaces the slice that was requested longest ago: first those with paint, then those without, each in the order
    // of `keys`, until all cached slices are of this image. Where there is no room for all painted slices, the rest of
    // them share the memory of one slice, and are built there one after the other while the image is drawn
    // (find_or_record). Throws RuntimeFailure for a paint that does not exist, or on a
    // field that came with its slice.
    void request(std::span<const SliceKey> keys);
    // The index of a requested slice among trees(); nothing where there was no room for it.
    std::optional<uint32_t> find(SliceKey key) const;
    // The key and the index of the slice with this paint, of those that are built, whose time is nearest to that of the
    // key; nothing where there is none.
    std::optional<std::pair<SliceKey, uint32_t>> nearest_built(SliceKey key) const;
    // Whether the last image requested the slice of this index.
    bool is_used(uint32_t slice) const { return slices_[slice].key && slices_[slice].last_used == images_; }
    // A number that changes whenever the slice of this index is built anew.
    uint64_t build_of(uint32_t slice) const { return slices_[slice].build; }
    // Drops all slices, but for one that came with the field.
    void forget();

    // Requests the slices that the next images will need, after request(). The first of them that is not cached is
    // built in parts by record_prefetch(), and replaces a slice that this image does not need, if there is one.
    void request_prefetch(std::span<const SliceKey> keys);

    // Builds the requested slices that are not built yet, except for those that share memory.
    void record_slices(gpu::Commands& commands);
    // Returns the index of a requested slice. One that shares memory is built first, and is valid until the next of
    // them is built. Returns nothing for a slice without paint for which there was no room.
    std::optional<uint32_t> find_or_record(gpu::Commands& commands, SliceKey key);
    // Builds `parts` parts of the slices that request_prefetch() requested.
    void record_prefetch(gpu::Commands& commands, uint32_t parts);

    const SliceTrees& trees() const { return trees_; }
    // What its slices take on the device, but for the field's own.
    uint64_t bytes() const;

  private:
    struct CachedSlice {
        std::optional<SliceKey> key;
        uint32_t parts = 0;           // how many of kSliceParts are built
        uint64_t last_used = 0;       // the number of the last image that needed it
        uint64_t last_requested = 0;  // the same, or an image before which it was prefetched
        uint64_t build = 0;           // the number of this build among all
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
    const Paints& paints_;
    // What builds slices.
    struct Builder {
        const LiveLeaves& live;
        SliceTrees trees;
        TreeSlicer slicer;
        bool is_defined = false;  // what makes the trees empty was recorded
        Builder(const gpu::Device& device, const Field& field, const LiveLeaves& live, uint32_t entries,
                uint32_t slices);
    };
    std::unique_ptr<Builder> builder_;  // null: the field came with its slice
    const SliceTrees& trees_;
    std::vector<CachedSlice> slices_;  // by index; at most one is partly built, and uses the live leaves
    std::optional<uint32_t> shared_;   // the slice whose memory painted slices share in this image
    std::vector<SliceKey> prefetch_;
    uint64_t images_ = 0, builds_ = 0;
    std::unique_ptr<Painter> painter_;  // created when first needed
    std::map<uint32_t, SlicePaint> bound_;
};

}  // namespace neuvv::render
