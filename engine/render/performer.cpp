#include "render/performer.h"

#include <algorithm>

namespace neuvv {

namespace {

// A part of a clip's leaves live in one of its frames, all those of a still.
uint32_t likely_entries(const Field& field) {
    const uint32_t most = most_entries(field);
    return field.frames == 1 ? most : std::min(most, most / 4 + 4096);
}

}  // namespace

Shading play_shading(const Field& field, glm::vec3 eye, double rays) {
    // Measured on lavapipe, degree 1: shading pays from a ray for three leaves.
    if (3 * rays < likely_entries(field)) return Shading::kPerRay;
    // Of half a leaf, in radians. Functions of degree n turn n times as fast as those of degree 1.
    constexpr float kSmallAngle = 0.02f;
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    const float half_leaf = 0.5f * field.leaf_diagonal * static_cast<float>(field.hh_degree);
    return half_leaf < kSmallAngle * glm::length(outside) ? Shading::kPerLeaf : Shading::kPerRay;
}

SlicePath::SlicePath(const Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
                     const RayBatch& rays, const TileRanges& ranges, uint32_t views, uint32_t entries,
                     uint64_t slice_budget)
    : cache(device, field, live, paints, entries, slice_budget),
      shaded(shaded_entries(device, cache.trees().capacity, views)),
      shader(device, field, cache.trees(), shaded),
      ranger(device, field, &cache.trees(), rays, ranges),
      unshaded_tracer(device, field, cache.trees(), cache.trees().entries, ranges, rays, Shading::kPerRay),
      shaded_tracer(device, field, cache.trees(), shaded, ranges, rays, Shading::kPerLeaf),
      counts_readback(device, "entries readback", cache.trees().counts.bytes, MemoryKind::kReadback) {}

InstanceDirectPath::InstanceDirectPath(const Device& device, const Field& field, const LiveLeaves& live,
                                       const RayBatch& rays, const TileRanges& ranges)
    : finder(device, field, live),
      ranger(device, field, nullptr, rays, ranges),
      tracer(device, field, live, rays, Walk::kDown, &ranges) {}

Performer::Performer(const Device& device, const Field& field, const Paints& paints, const RayBatch& rays,
                     const TileRanges& ranges, uint32_t views, uint64_t slice_budget)
    : device_(device),
      field_(field),
      paints_(paints),
      rays_(rays),
      ranges_(ranges),
      views_(views),
      slice_budget_(slice_budget),
      live_(device, field, slice_budget > 0 ? field.leaf_count : 1) {
    if (slice_budget > 0) make_slices(likely_entries(field));
}

void Performer::make_slices(uint32_t entries) {
    slices_ =
        std::make_unique<SlicePath>(device_, field_, live_, paints_, rays_, ranges_, views_, entries, slice_budget_);
    paints_sliced_ = paints_.count();
}

// Slices where paint needs one, and more of them where there are more paints than they were made for.
void Performer::make_room(bool any_painted) {
    if (!slices_ && any_painted) {
        direct_.reset();  // it has the live leaves
        live_ = LiveLeaves(device_, field_, field_.leaf_count);
        make_slices(likely_entries(field_));
    }
    if (!slices_ || paints_.count() <= paints_sliced_) return;
    const SliceTrees& trees = slices_->cache.trees();
    const bool all_of_clip = trees.slices >= (1 + paints_sliced_) * field_.frames;  // there may be budget for more
    const uint32_t entries = trees.capacity;
    paints_sliced_ = paints_.count();
    if (!all_of_clip || slice_bytes(field_, entries) * (trees.slices + uint64_t{1}) > slice_budget_) return;
    slices_.reset();  // before there are others
    make_slices(entries);
}

void Performer::prepare(std::span<const DrawnInstance> instances, std::span<const SliceKey> next) {
    asked_.clear();
    for (const DrawnInstance& instance : instances) asked_.push_back({instance.frame, instance.paint});
    const auto is_painted = [](const SliceKey& key) { return key.paint != 0; };
    make_room(std::any_of(asked_.begin(), asked_.end(), is_painted));
    bool all_kept = slices_ != nullptr, all_sliced = all_kept;
    if (slices_) {
        slices_->cache.ask(asked_);
        for (const SliceKey& key : asked_) {
            const bool kept = slices_->cache.find(key).has_value();
            all_kept &= kept;
            all_sliced &= kept || is_painted(key);
        }
        if (all_kept) slices_->cache.ask_ahead(next);  // else there is no room, and live leaves serve others
    }
    if (!all_sliced && !direct_) direct_ = std::make_unique<InstanceDirectPath>(device_, field_, live_, rays_, ranges_);
}

bool Performer::enlarge_slices() {
    if (!slices_) return false;
    const SliceTrees& trees = slices_->cache.trees();
    const std::span counts(slices_->counts_readback.as<LiveCount>(), trees.slices);
    if (std::none_of(counts.begin(), counts.end(), [](const LiveCount& count) { return count.overflow > 0; }))
        return false;
    const uint32_t entries = std::min(most_entries(field_), 2 * trees.capacity);
    slices_.reset();  // before there is another
    make_slices(entries);
    return true;
}

void record_slices(Commands& commands, Performer& performer) {
    if (SlicePath* path = performer.slices()) record_slices(commands, path->cache);
}

void record_slices_ahead(Commands& commands, Performer& performer, uint32_t parts) {
    SlicePath* path = performer.slices();
    if (!path) return;
    record_ahead(commands, path->cache, parts);
    copy(commands, path->cache.trees().counts, path->counts_readback, path->counts_readback.bytes);
}

void record_instance(Commands& commands, const Performer& performer, const DrawnInstance& instance,
                     const ViewLayout& layout, float stop) {
    SlicePath* path = performer.slices();
    const std::optional<uint32_t> slice =
        path ? record_slice_of(commands, path->cache, {instance.frame, instance.paint}) : std::nullopt;
    if (!slice) {
        const InstanceDirectPath& direct = *performer.direct();
        record_rows(commands, direct.finder, instance.frame);
        record_tile_ranges(commands, direct.ranger, 0, instance.first_camera, instance.range_level, layout);
        record_direct_instance(commands, direct.tracer, instance.first_camera, stop);
        return;
    }
    const bool shaded = instance.shading == Shading::kPerLeaf;
    for (uint32_t view = 0; shaded && view < layout.views; view++) {
        const RangeView& seen = performer.ranges().views.as<RangeView>()[instance.first_camera + view];
        record_shade(commands, path->shader, *slice, view, glm::vec3(seen.eye));
    }
    record_tile_ranges(commands, path->ranger, *slice, instance.first_camera, instance.range_level, layout);
    record_trace_tree(commands, shaded ? path->shaded_tracer : path->unshaded_tracer, *slice, instance.first_camera,
                      stop);
}

}  // namespace neuvv
