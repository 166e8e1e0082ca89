// Slices of one field that are kept on the device: those shown last, as many as a budget holds.
#pragma once

#include <optional>
#include <span>

#include "render/slice_tree.h"

namespace neuvv {

// Bytes that the slices of a performer may take on the device, however many instances and frames are shown.
constexpr uint64_t kSliceBudget = uint64_t{256} << 20;

class SliceCache {
  public:
    // Room for as many slices of `entries` entries as the budget allows, one at least. `live` is scratch.
    SliceCache(const Device& device, const Field& field, const LiveLeaves& live, uint32_t entries,
               uint64_t budget_bytes);

    // Before a picture: it needs the slices of these frames. Those that are kept stay; the others take the places of
    // those that were not asked for for longest, the first frames first, until all places are this picture's.
    void ask(std::span<const float> frames);
    // Where the slice of a frame that was asked for is; none where there was no room.
    std::optional<uint32_t> find(float frame) const;
    void forget();

    // After ask(): the slices of these frames will be needed next. The first of them that is not kept is built in parts
    // (record_ahead), in the place of one that this picture does not need, if there is any.
    void ask_ahead(std::span<const float> frames);

    const SliceTrees& trees() const { return trees_; }

  private:
    friend void record_slices(Commands& commands, SliceCache& cache);
    friend void record_ahead(Commands& commands, SliceCache& cache, uint32_t parts);
    struct Kept {
        std::optional<float> frame;
        uint32_t parts = 0;  // of kSliceParts that are built
        uint64_t shown = 0;  // by which picture last
        uint64_t asked = 0;  // the same, or ahead of one
    };
    Kept* kept_of(float frame);
    Kept& oldest();
    void build(Commands& commands, uint32_t slice, uint32_t parts);
    SliceTrees trees_;
    TreeSlicer slicer_;
    std::vector<Kept> kept_;  // per slice; of one at most a part is built, which then has the live leaves
    std::vector<float> ahead_;
    uint64_t pictures_ = 0;
};

// Builds the slices that were asked for and are not there.
void record_slices(Commands& commands, SliceCache& cache);

// Builds so many parts of those that were asked for ahead.
void record_ahead(Commands& commands, SliceCache& cache, uint32_t parts);

}  // namespace neuvv
