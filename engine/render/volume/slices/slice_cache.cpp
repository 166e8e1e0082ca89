#include "render/volume/slices/slice_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace neuvv::render {

namespace {

// The number of slices for which the budget, the clip and the device have room, at least one.
uint32_t slice_count(const gpu::Device& device, const Field& field, size_t paints, uint32_t entries,
                     uint64_t budget_bytes) {
    const uint64_t texels = uint64_t{sh_count(field.hh_degree)} * std::max(entries, 1u);
    const uint64_t bytes = std::max<uint64_t>(4 * kEntryWords * texels, field.nodes.bytes);
    const uint64_t addressed = std::min(device.buffers().max_elements(4 * kEntryWords) / texels,
                                        device.buffers().max_elements(16) / std::max(field.node_count(), 1u));
    const uint64_t allocated = device.max_allocation_bytes() / bytes;
    const uint64_t of_clip = (1 + paints) * field.frames;
    const uint64_t wanted = std::min<uint64_t>(budget_bytes / slice_bytes(field, entries), of_clip);
    return static_cast<uint32_t>(std::max<uint64_t>(std::min({wanted, addressed, allocated}), 1));
}

}  // namespace

uint64_t slice_budget(const gpu::HeapMemory& memory, uint64_t wanted) {
    if (wanted == 0) return 0;
    const uint64_t room =
        memory.budget ? (*memory.budget - std::min(*memory.budget, memory.used)) / 2 : memory.size / 8;
    return std::max<uint64_t>(std::min(wanted, room), 1);
}

SliceCache::Builder::Builder(const gpu::Device& device, const Field& field, const LiveLeaves& given_live,
                             uint32_t entries, uint32_t slices)
    : live(given_live),
      trees(device, field, entries, slices,
            TreesBegin::kUndefined),  // as a new field may come while images are drawn
      slicer(device, field, live, trees) {}

SliceCache::SliceCache(const gpu::Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
                       uint32_t entries, uint64_t budget_bytes)
    : device_(device),
      field_(field),
      paints_(paints),
      builder_(std::make_unique<Builder>(device, field, live, entries,
                                         slice_count(device, field, paints.count(), entries, budget_bytes))),
      trees_(builder_->trees),
      slices_(trees_.slices) {}

SliceCache::SliceCache(const gpu::Device& device, const Field& field, const Paints& paints)
    : device_(device), field_(field), paints_(paints), trees_(*field.slice), slices_(1) {
    forget();
}

uint64_t SliceCache::bytes() const {
    return builder_ ? trees_.slices * slice_bytes(field_, trees_.capacity) : 0;
}

SliceCache::CachedSlice* SliceCache::find_cached(SliceKey key) {
    const std::optional<uint32_t> found = find(key);
    return found ? &slices_[*found] : nullptr;
}

SliceCache::CachedSlice& SliceCache::oldest() {
    return *std::min_element(slices_.begin(), slices_.end(), [](const CachedSlice& a, const CachedSlice& b) {
        return a.last_requested < b.last_requested;
    });
}

// The slice that a new one may replace, or null. A painted slice may even replace one without paint that this image
// needs.
SliceCache::CachedSlice* SliceCache::replaceable_for(SliceKey key) {
    CachedSlice& slice = oldest();
    if (slice.last_requested < images_) return &slice;
    if (key.paint == 0) return nullptr;
    const auto plain = std::find_if(slices_.begin(), slices_.end(),
                                    [](const CachedSlice& one) { return one.key && one.key->paint == 0; });
    return plain == slices_.end() ? nullptr : &*plain;
}

// The one with the fewest built parts, so that the least work is lost.
void SliceCache::choose_shared() {
    const auto least_built = std::min_element(
        slices_.begin(), slices_.end(), [](const CachedSlice& a, const CachedSlice& b) { return a.parts < b.parts; });
    *least_built = {std::nullopt, 0, images_, images_};
    shared_ = static_cast<uint32_t>(least_built - slices_.begin());
}

// Writes the descriptors of paints, before the image is recorded.
void SliceCache::bind(std::span<const SliceKey> keys) {
    std::erase_if(bound_, [this](const auto& one) { return !paints_.find(one.first); });
    for (const SliceKey& key : keys) {
        if (key.paint == 0 || bound_.contains(key.paint)) continue;
        const Paint* paint = paints_.find(key.paint);
        if (!paint) throw RuntimeFailure(fmt::format("there is no paint {}", key.paint));
        if (!builder_) throw RuntimeFailure("a frame of a stream cannot be painted");
        if (!painter_) painter_ = std::make_unique<Painter>(device_, field_, builder_->live, trees_);
        bound_.try_emplace(key.paint, *painter_, *paint);
    }
}

void SliceCache::request(std::span<const SliceKey> keys) {
    ++images_;
    prefetch_.clear();
    shared_.reset();
    bind(keys);
    for (const SliceKey& key : keys)
        if (CachedSlice* cached = find_cached(key)) cached->last_used = cached->last_requested = images_;
    for (const bool painted : {true, false})
        for (const SliceKey& key : keys) {
            if ((key.paint != 0) != painted || find_cached(key)) continue;
            if (CachedSlice* slice = replaceable_for(key)) {
                *slice = {key, 0, images_, images_};
            } else {
                if (painted && !shared_) choose_shared();
                break;
            }
        }
}

void SliceCache::request_prefetch(std::span<const SliceKey> keys) {
    prefetch_.assign(keys.begin(), keys.end());
    bind(keys);
    for (const SliceKey& key : prefetch_)
        if (CachedSlice* cached = find_cached(key)) cached->last_requested = images_;
}

std::optional<uint32_t> SliceCache::find(SliceKey key) const {
    if (!builder_ && key.paint == 0) return 0;  // a field of one frame
    for (uint32_t i = 0; i < slices_.size(); ++i)
        if (slices_[i].key == key) return i;
    return std::nullopt;
}

std::optional<std::pair<SliceKey, uint32_t>> SliceCache::nearest_built(SliceKey key) const {
    std::optional<std::pair<SliceKey, uint32_t>> nearest;
    for (uint32_t i = 0; i < slices_.size(); ++i) {
        const CachedSlice& slice = slices_[i];
        if (!slice.key || slice.parts < kSliceParts || slice.key->paint != key.paint) continue;
        const bool is_nearer =
            !nearest || std::abs(slice.key->frame - key.frame) < std::abs(nearest->first.frame - key.frame);
        if (is_nearer) nearest = {*slice.key, i};
    }
    return nearest;
}

void SliceCache::forget() {
    std::fill(slices_.begin(), slices_.end(), CachedSlice{});
    if (!builder_) slices_[0] = {SliceKey{}, kSliceParts};
}

const SlicePaint* SliceCache::paint_of(SliceKey key) const {
    return key.paint == 0 ? nullptr : &bound_.at(key.paint);
}

void SliceCache::build(gpu::Commands& commands, uint32_t slice, uint32_t parts) {
    CachedSlice& cached = slices_[slice];
    const SliceKey key = *cached.key;
    for (uint32_t i = 0; i < slices_.size(); ++i)  // another partly built slice loses the live leaves
        if (i != slice && slices_[i].parts < kSliceParts) slices_[i].parts = 0;
    if (cached.parts == 0) cached.build = ++builds_;
    if (cached.parts == 0 && parts >= kSliceParts) {
        record_slice_tree(commands, builder_->slicer, slice, key.frame, paint_of(key));
        cached.parts = kSliceParts;
    }
    for (; parts > 0 && cached.parts < kSliceParts; --parts)
        record_slice_part(commands, builder_->slicer, slice, key.frame, cached.parts++, paint_of(key));
}

void SliceCache::record_slices(gpu::Commands& commands) {
    if (!builder_) return;
    if (!std::exchange(builder_->is_defined, true)) record_empty(commands, trees_);
    const auto is_missing = [this](const CachedSlice& cached) {
        return cached.key && cached.last_used == images_ && cached.parts < kSliceParts;
    };
    for (const bool begun : {true, false})  // first the slice that is partly built
        for (uint32_t i = 0; i < slices_.size(); ++i)
            if (is_missing(slices_[i]) && (slices_[i].parts > 0) == begun) build(commands, i, kSliceParts);
}

std::optional<uint32_t> SliceCache::find_or_record(gpu::Commands& commands, SliceKey key) {
    const std::optional<uint32_t> there = find(key);
    if (there || key.paint == 0 || !shared_) return there;
    slices_[*shared_] = {key, 0, images_, images_};
    build(commands, *shared_, kSliceParts);
    return shared_;
}

void SliceCache::record_prefetch(gpu::Commands& commands, uint32_t parts) {
    for (const SliceKey& key : prefetch_) {
        CachedSlice* cached = find_cached(key);
        if (!cached) {
            cached = &oldest();
            if (cached->last_requested == images_) return;
            *cached = {key, 0, 0, images_};
        }
        const uint32_t wanted = std::min(parts, kSliceParts - cached->parts);
        if (wanted > 0) build(commands, static_cast<uint32_t>(cached - slices_.data()), wanted);
        parts -= wanted;
        if (parts == 0) return;
    }
}

}  // namespace neuvv::render
