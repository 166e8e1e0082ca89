#include "render/slice_cache.h"

#include <algorithm>

namespace neuvv {

SliceCache::SliceCache(const Device& device, const Field& field, const LiveLeaves& live, uint32_t entries,
                       uint64_t budget_bytes)
    : trees_(device, field, entries,
             static_cast<uint32_t>(std::clamp<uint64_t>(budget_bytes / slice_bytes(field, entries), 1, field.frames))),
      slicer_(device, field, live, trees_),
      kept_(trees_.slices) {}

SliceCache::Kept* SliceCache::kept_of(float frame) {
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [frame](const Kept& one) { return one.frame == frame; });
    return found == kept_.end() ? nullptr : &*found;
}

void SliceCache::ask(std::span<const float> frames) {
    pictures_++;
    for (const float frame : frames)
        if (Kept* kept = kept_of(frame)) kept->asked = pictures_;
    for (const float frame : frames) {
        if (kept_of(frame)) continue;
        Kept& oldest = *std::min_element(kept_.begin(), kept_.end(),
                                         [](const Kept& a, const Kept& b) { return a.asked < b.asked; });
        if (oldest.asked == pictures_) return;
        oldest = {frame, false, pictures_};
    }
}

std::optional<uint32_t> SliceCache::find(float frame) const {
    for (uint32_t i = 0; i < kept_.size(); i++)
        if (kept_[i].frame == frame) return i;
    return std::nullopt;
}

void SliceCache::forget() {
    std::fill(kept_.begin(), kept_.end(), Kept{});
}

void record_slices(Commands& commands, SliceCache& cache) {
    for (uint32_t i = 0; i < cache.kept_.size(); i++) {
        SliceCache::Kept& kept = cache.kept_[i];
        if (!kept.frame || kept.built) continue;
        record_slice_tree(commands, cache.slicer_, i, *kept.frame);
        kept.built = true;
    }
}

}  // namespace neuvv
