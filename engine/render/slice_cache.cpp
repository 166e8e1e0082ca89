#include "render/slice_cache.h"

#include <algorithm>

namespace neuvv {

namespace {

// As many slices as budget, clip and device have room for, one at least.
uint32_t slice_count(const Device& device, const Field& field, uint32_t entries, uint64_t budget_bytes) {
    const uint64_t texels = uint64_t{sh_count(field.hh_degree)} * std::max(entries, 1u);
    const uint64_t bytes = std::max<uint64_t>(4 * kEntryWords * texels, field.nodes.bytes);
    const uint64_t addressed = device.limits().maxTexelBufferElements / std::max<uint64_t>(texels, field.node_count());
    const uint64_t allocated = device.max_allocation_bytes() / bytes;
    const uint64_t wanted = std::min<uint64_t>(budget_bytes / slice_bytes(field, entries), field.frames);
    return static_cast<uint32_t>(std::max<uint64_t>(std::min({wanted, addressed, allocated}), 1));
}

}  // namespace

SliceCache::SliceCache(const Device& device, const Field& field, const LiveLeaves& live, uint32_t entries,
                       uint64_t budget_bytes)
    : trees_(device, field, entries, slice_count(device, field, entries, budget_bytes)),
      slicer_(device, field, live, trees_),
      kept_(trees_.slices) {}

SliceCache::Kept* SliceCache::kept_of(float frame) {
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [frame](const Kept& one) { return one.frame == frame; });
    return found == kept_.end() ? nullptr : &*found;
}

SliceCache::Kept& SliceCache::oldest() {
    return *std::min_element(kept_.begin(), kept_.end(),
                             [](const Kept& a, const Kept& b) { return a.asked < b.asked; });
}

void SliceCache::ask(std::span<const float> frames) {
    pictures_++;
    ahead_.clear();
    for (const float frame : frames)
        if (Kept* kept = kept_of(frame)) kept->shown = kept->asked = pictures_;
    for (const float frame : frames) {
        if (kept_of(frame)) continue;
        Kept& place = oldest();
        if (place.asked == pictures_) return;
        place = {frame, 0, pictures_, pictures_};
    }
}

void SliceCache::ask_ahead(std::span<const float> frames) {
    ahead_.assign(frames.begin(), frames.end());
    for (const float frame : ahead_)
        if (Kept* kept = kept_of(frame)) kept->asked = pictures_;
}

std::optional<uint32_t> SliceCache::find(float frame) const {
    for (uint32_t i = 0; i < kept_.size(); i++)
        if (kept_[i].frame == frame) return i;
    return std::nullopt;
}

void SliceCache::forget() {
    std::fill(kept_.begin(), kept_.end(), Kept{});
}

void SliceCache::build(Commands& commands, uint32_t slice, uint32_t parts) {
    Kept& kept = kept_[slice];
    for (uint32_t i = 0; i < kept_.size(); i++)  // who else has a part gives up the live leaves
        if (i != slice && kept_[i].parts < kSliceParts) kept_[i].parts = 0;
    if (kept.parts == 0 && parts >= kSliceParts) {
        record_slice_tree(commands, slicer_, slice, *kept.frame);
        kept.parts = kSliceParts;
    }
    for (; parts > 0 && kept.parts < kSliceParts; parts--)
        record_slice_part(commands, slicer_, slice, *kept.frame, kept.parts++);
}

void record_slices(Commands& commands, SliceCache& cache) {
    const auto is_wanted = [&cache](const SliceCache::Kept& kept) {
        return kept.frame && kept.shown == cache.pictures_ && kept.parts < kSliceParts;
    };
    for (const bool begun : {true, false})  // first the one that has a part
        for (uint32_t i = 0; i < cache.kept_.size(); i++)
            if (is_wanted(cache.kept_[i]) && (cache.kept_[i].parts > 0) == begun) cache.build(commands, i, kSliceParts);
}

void record_ahead(Commands& commands, SliceCache& cache, uint32_t parts) {
    for (const float frame : cache.ahead_) {
        SliceCache::Kept* kept = cache.kept_of(frame);
        if (!kept) {
            kept = &cache.oldest();
            if (kept->asked == cache.pictures_) return;
            *kept = {frame, 0, 0, cache.pictures_};
        }
        const uint32_t wanted = std::min(parts, kSliceParts - kept->parts);
        if (wanted > 0) cache.build(commands, static_cast<uint32_t>(kept - cache.kept_.data()), wanted);
        parts -= wanted;
        if (parts == 0) return;
    }
}

}  // namespace neuvv
