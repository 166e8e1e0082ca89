#include "render/slice_cache.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace neuvv::render {

namespace {

// As many slices as budget, clip and device have room for, one at least.
uint32_t slice_count(const gpu::Device& device, const Field& field, size_t paints, uint32_t entries,
                     uint64_t budget_bytes) {
    const uint64_t texels = uint64_t{sh_count(field.hh_degree)} * std::max(entries, 1u);
    const uint64_t bytes = std::max<uint64_t>(4 * kEntryWords * texels, field.nodes.bytes);
    const uint64_t addressed = device.limits().maxTexelBufferElements / std::max<uint64_t>(texels, field.node_count());
    const uint64_t allocated = device.max_allocation_bytes() / bytes;
    const uint64_t of_clip = (1 + paints) * field.frames;
    const uint64_t wanted = std::min<uint64_t>(budget_bytes / slice_bytes(field, entries), of_clip);
    return static_cast<uint32_t>(std::max<uint64_t>(std::min({wanted, addressed, allocated}), 1));
}

}  // namespace

SliceCache::SliceCache(const gpu::Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
                       uint32_t entries, uint64_t budget_bytes)
    : device_(device),
      field_(field),
      live_(live),
      paints_(paints),
      trees_(device, field, entries, slice_count(device, field, paints.count(), entries, budget_bytes)),
      slicer_(device, field, live, trees_),
      kept_(trees_.slices) {}

SliceCache::Kept* SliceCache::kept_of(SliceKey key) {
    const auto found = std::find_if(kept_.begin(), kept_.end(), [key](const Kept& one) { return one.key == key; });
    return found == kept_.end() ? nullptr : &*found;
}

SliceCache::Kept& SliceCache::oldest() {
    return *std::min_element(kept_.begin(), kept_.end(),
                             [](const Kept& a, const Kept& b) { return a.asked < b.asked; });
}

// The place that a slice may take which is not kept; a painted one may take that of one that is not.
SliceCache::Kept* SliceCache::place_for(SliceKey key) {
    Kept& place = oldest();
    if (place.asked < images_) return &place;
    if (key.paint == 0) return nullptr;
    const auto plain =
        std::find_if(kept_.begin(), kept_.end(), [](const Kept& one) { return one.key && one.key->paint == 0; });
    return plain == kept_.end() ? nullptr : &*plain;
}

// Where least is lost.
void SliceCache::lend_place() {
    const auto least =
        std::min_element(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.parts < b.parts; });
    *least = {std::nullopt, 0, images_, images_};
    lent_ = static_cast<uint32_t>(least - kept_.begin());
}

// Descriptors are written before the image, not in it.
void SliceCache::bind(std::span<const SliceKey> keys) {
    std::erase_if(bound_, [this](const auto& one) { return !paints_.find(one.first); });
    for (const SliceKey& key : keys) {
        if (key.paint == 0 || bound_.contains(key.paint)) continue;
        const Paint* paint = paints_.find(key.paint);
        if (!paint) throw RuntimeFailure(fmt::format("there is no paint {}", key.paint));
        if (!painter_) painter_ = std::make_unique<Painter>(device_, field_, live_, trees_);
        bound_.try_emplace(key.paint, *painter_, *paint);
    }
}

void SliceCache::ask(std::span<const SliceKey> keys) {
    images_++;
    ahead_.clear();
    lent_.reset();
    bind(keys);
    for (const SliceKey& key : keys)
        if (Kept* kept = kept_of(key)) kept->shown = kept->asked = images_;
    for (const bool painted : {true, false})
        for (const SliceKey& key : keys) {
            if ((key.paint != 0) != painted || kept_of(key)) continue;
            if (Kept* place = place_for(key)) {
                *place = {key, 0, images_, images_};
            } else {
                if (painted && !lent_) lend_place();
                break;
            }
        }
}

void SliceCache::ask_ahead(std::span<const SliceKey> keys) {
    ahead_.assign(keys.begin(), keys.end());
    bind(keys);
    for (const SliceKey& key : ahead_)
        if (Kept* kept = kept_of(key)) kept->asked = images_;
}

std::optional<uint32_t> SliceCache::find(SliceKey key) const {
    for (uint32_t i = 0; i < kept_.size(); i++)
        if (kept_[i].key == key) return i;
    return std::nullopt;
}

void SliceCache::forget() {
    std::fill(kept_.begin(), kept_.end(), Kept{});
}

const SlicePaint* SliceCache::paint_of(SliceKey key) const {
    return key.paint == 0 ? nullptr : &bound_.at(key.paint);
}

void SliceCache::build(gpu::Commands& commands, uint32_t slice, uint32_t parts) {
    Kept& kept = kept_[slice];
    const SliceKey key = *kept.key;
    for (uint32_t i = 0; i < kept_.size(); i++)  // who else has a part gives up the live leaves
        if (i != slice && kept_[i].parts < kSliceParts) kept_[i].parts = 0;
    if (kept.parts == 0 && parts >= kSliceParts) {
        record_slice_tree(commands, slicer_, slice, key.frame, paint_of(key));
        kept.parts = kSliceParts;
    }
    for (; parts > 0 && kept.parts < kSliceParts; parts--)
        record_slice_part(commands, slicer_, slice, key.frame, kept.parts++, paint_of(key));
}

void SliceCache::record_slices(gpu::Commands& commands) {
    const auto is_wanted = [this](const Kept& kept) {
        return kept.key && kept.shown == images_ && kept.parts < kSliceParts;
    };
    for (const bool begun : {true, false})  // first the one that has a part
        for (uint32_t i = 0; i < kept_.size(); i++)
            if (is_wanted(kept_[i]) && (kept_[i].parts > 0) == begun) build(commands, i, kSliceParts);
}

std::optional<uint32_t> SliceCache::record_slice_of(gpu::Commands& commands, SliceKey key) {
    const std::optional<uint32_t> there = find(key);
    if (there || key.paint == 0 || !lent_) return there;
    kept_[*lent_] = {key, 0, images_, images_};
    build(commands, *lent_, kSliceParts);
    return lent_;
}

void SliceCache::record_ahead(gpu::Commands& commands, uint32_t parts) {
    for (const SliceKey& key : ahead_) {
        Kept* kept = kept_of(key);
        if (!kept) {
            kept = &oldest();
            if (kept->asked == images_) return;
            *kept = {key, 0, 0, images_};
        }
        const uint32_t wanted = std::min(parts, kSliceParts - kept->parts);
        if (wanted > 0) build(commands, static_cast<uint32_t>(kept - kept_.data()), wanted);
        parts -= wanted;
        if (parts == 0) return;
    }
}

}  // namespace neuvv::render
