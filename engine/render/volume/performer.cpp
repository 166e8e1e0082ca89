#include "render/volume/performer.h"

#include <algorithm>
#include <cstring>

namespace neuvv::render {

namespace {

// A first guess: a quarter of the leaves of a clip live at a time, but all leaves of a single frame.
uint32_t likely_entries(const Field& field) {
    const uint32_t max = max_entries(field);
    return field.frames == 1 ? max : std::min(max, max / 4 + 4096);
}

bool any_painted(std::span<const SliceKey> slices) {
    return std::any_of(slices.begin(), slices.end(), [](const SliceKey& key) { return key.paint != 0; });
}

}  // namespace

Shading play_shading(const Field& field, glm::vec3 eye, double rays) {
    // Measured on lavapipe at degree 1: shading a leaf pays where there is at least one ray for three leaves.
    if (3 * rays < likely_entries(field)) return Shading::kPerRay;
    // The angle under which half a leaf may be seen, in radians. Functions of degree n change n times as fast with the
    // direction as those of degree 1.
    constexpr float kSmallAngle = 0.02f;
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    const float half_leaf = 0.5f * field.leaf_diagonal * static_cast<float>(field.hh_degree);
    return half_leaf < kSmallAngle * glm::length(outside) ? Shading::kPerLeaf : Shading::kPerRay;
}

TargetPasses::TargetPasses(const gpu::Device& given_device, const Field& given_field, const LiveLeaves* given_live,
                           const SliceTrees* given_trees, const RayTarget& given_target, uint32_t max_views)
    : device(given_device),
      field(given_field),
      live(given_live),
      trees(given_trees),
      target(given_target),
      views(max_views) {}

TargetPasses::Shaded::Shaded(const gpu::Device& device, const Field& field, const SliceTrees& trees, uint32_t views)
    : entries(shaded_entries(device, trees.capacity, views)), shader(device, field, trees, entries) {}

size_t TargetPasses::tree_tracer_index(Shading shading, RayOutput output) {
    return 5 * static_cast<size_t>(shading) + static_cast<size_t>(output);
}

void TargetPasses::ensure_tree_tracer(Shading shading, RayOutput output, const Intervals* intervals) {
    std::unique_ptr<TreeTracer>& tracer = tree_tracers[tree_tracer_index(shading, output)];
    if (tracer) return;
    if (!tree_ranger) tree_ranger = std::make_unique<TileRanger>(device, field, trees, target.ranges);
    const bool shaded = shading == Shading::kPerLeaf;
    if (shaded && !per_leaf) per_leaf = std::make_unique<Shaded>(device, field, *trees, views);
    tracer = std::make_unique<TreeTracer>(device, field, *trees, shaded ? per_leaf->entries : trees->entries, target,
                                          shading, output, intervals);
}

void TargetPasses::ensure_highlighter(const BoneBinder& binder) {
    if (!highlighter) highlighter = std::make_unique<Highlighter>(device, binder, per_leaf->entries);
}

void TargetPasses::ensure_direct_ranger() {
    if (!direct_ranger) direct_ranger = std::make_unique<TileRanger>(device, field, nullptr, target.ranges);
}

void TargetPasses::ensure_direct_tracer(RayOutput output, const Intervals* intervals) {
    std::unique_ptr<DirectTracer>& tracer = direct_tracers[static_cast<size_t>(output)];
    if (tracer) return;
    ensure_direct_ranger();
    tracer = std::make_unique<DirectTracer>(device, field, *live, target, output, intervals);
}

void TargetPasses::forget_intervals() {
    for (const Shading shading : {Shading::kPerRay, Shading::kPerLeaf, Shading::kNone})
        tree_tracers[tree_tracer_index(shading, RayOutput::kIntervals)].reset();
    direct_tracers[static_cast<size_t>(RayOutput::kIntervals)].reset();
}

Performer::Performer(const gpu::Device& device, const Field& field, const Paints& paints, uint64_t slice_budget)
    : device_(device), field_(field), paints_(paints), slice_budget_(slice_budget) {
    if (!field.slice) make_live(slice_budget > 0 ? field.leaf_count : 1);
    if (field.slice || slice_budget > 0) make_slices(likely_entries(field));
}

void Performer::make_live(uint32_t slots) {
    finder_.reset();
    live_ = std::make_unique<LiveLeaves>(device_, field_, slots);
    finder_ = std::make_unique<LiveFinder>(device_, field_, *live_);
}

void Performer::make_slices(uint32_t entries) {
    passes_.clear();  // they are bound to the slices
    bone_binder_.reset();
    pickers_.clear();
    slices_.reset();  // frees their memory before the new ones are created
    slices_ = field_.slice ? std::make_unique<SliceCache>(device_, field_, paints_)
                           : std::make_unique<SliceCache>(device_, field_, *live_, paints_, entries, slice_budget_);
    for (gpu::Buffer& counts : counts_readback_) {
        counts = gpu::Buffer(device_, "entries readback", slices_->trees().counts.bytes, gpu::MemoryKind::kReadback);
        std::memset(counts.mapped, 0, counts.bytes);  // images that are under way do not write it
    }
    for (const auto& [target, views] : targets_) passes_.push_back(make_passes(*target, views));
    slice_paint_count_ = paints_.count();
}

// Creates slices where paint needs one and there are none, and more slices where there are more paints than before.
void Performer::make_slices_for_paint(bool are_painted) {
    if (!slices_ && are_painted) {
        passes_.clear();  // they are bound to the live leaves
        make_live(field_.leaf_count);
        make_slices(likely_entries(field_));
    }
    if (!slices_ || field_.slice || paints_.count() <= slice_paint_count_) return;
    const SliceTrees& trees = slices_->trees();
    // Whether the number of slices was limited by the clip, not by the budget.
    const bool all_of_clip = trees.slices >= (1 + slice_paint_count_) * field_.frames;
    const uint32_t entries = trees.capacity;
    slice_paint_count_ = paints_.count();
    if (!all_of_clip || slice_bytes(field_, entries) * (trees.slices + uint64_t{1}) > slice_budget_) return;
    make_slices(entries);
}

std::unique_ptr<TargetPasses> Performer::make_passes(const RayTarget& target, uint32_t views) const {
    return std::make_unique<TargetPasses>(device_, field_, live_.get(), slices_ ? &slices_->trees() : nullptr, target,
                                          views);
}

uint32_t Performer::add_target(const RayTarget& target, uint32_t views) {
    targets_.emplace_back(&target, views);
    passes_.push_back(make_passes(target, views));
    return static_cast<uint32_t>(passes_.size()) - 1;
}

void Performer::replace_target(uint32_t index, const RayTarget& target, uint32_t views) {
    targets_[index] = {&target, views};
    passes_[index] = make_passes(target, views);
}

bool Performer::replaces_slices(std::span<const SliceKey> slices) const {
    if (field_.slice) return false;
    return slices_ ? paints_.count() > slice_paint_count_ : any_painted(slices);
}

void Performer::prepare(std::span<const SliceKey> slices, std::span<const SliceKey> next) {
    make_slices_for_paint(any_painted(slices));
    if (!slices_) return;
    slices_->request(slices);
    // Otherwise there is no room for more slices, and the buffers of live leaves are used for other slices.
    if (std::all_of(slices.begin(), slices.end(),
                    [this](const SliceKey& key) { return slices_->find(key).has_value(); }))
        slices_->request_prefetch(next);
}

void Performer::prepare(uint32_t target, const DrawnInstance& instance, const Intervals* intervals) {
    if (slices_ && (instance.paint != 0 || slices_->find(instance.slice()))) {
        passes_[target]->ensure_tree_tracer(instance.shading, instance.output, intervals);
        if (instance.highlight) {
            if (!bone_binder_) bone_binder_ = std::make_unique<BoneBinder>(device_, field_, slices_->trees());
            passes_[target]->ensure_highlighter(*bone_binder_);
        }
    }
    if (slices_ && slices_->find(instance.slice())) return;
    if (slices_ && instance.paint != 0)
        passes_[target]->ensure_direct_ranger();
    else
        passes_[target]->ensure_direct_tracer(instance.output, intervals);
}

void Performer::forget_intervals() {
    for (const auto& passes : passes_) passes->forget_intervals();
}

uint64_t Performer::used_entries(uint32_t slot) const {
    uint64_t entries = 0;
    for (uint32_t slice = 0; slices_ && slice < slices_->trees().slices; ++slice)
        if (slices_->is_used(slice)) entries += counts_readback_[slot].as<LiveCount>()[slice].slots;
    return entries;
}

bool Performer::overflowed(uint32_t slot) const {
    if (!slices_) return false;
    const std::span counts(counts_readback_[slot].as<LiveCount>(), slices_->trees().slices);
    return std::any_of(counts.begin(), counts.end(), [](const LiveCount& count) { return count.overflow > 0; });
}

void Performer::enlarge_slices() {
    make_slices(std::min(max_entries(field_), 2 * slices_->trees().capacity));
}

SlicePicker& Performer::idle_picker() {
    constexpr uint32_t kRaysAtOnce = 64;
    for (const auto& picker : pickers_)
        if (!picker->is_picking()) return *picker;
    return *pickers_.emplace_back(
        std::make_unique<SlicePicker>(device_, field_, slices_->trees(), kRaysAtOnce, PickColours::kYes));
}

void record_slices(gpu::Commands& commands, Performer& performer) {
    if (SliceCache* cache = performer.slices()) cache->record_slices(commands);
}

void record_prefetch(gpu::Commands& commands, Performer& performer, uint32_t parts, uint32_t slot) {
    SliceCache* cache = performer.slices();
    if (!cache) return;
    cache->record_prefetch(commands, parts);
    const gpu::Buffer& readback = performer.counts_readback(slot);
    gpu::copy(commands, cache->trees().counts, readback, readback.bytes);
    gpu::compute_barrier(commands);
}

namespace {

// Computes the tile ranges of an instance and returns its slice. Without a slice, the rows A_t and B_t are recorded in
// place of it (unless the instance is only counted).
std::optional<uint32_t> record_ranges(gpu::Commands& commands, Performer& performer, uint32_t target,
                                      const DrawnInstance& instance, const ViewLayout& layout, bool counted) {
    const TargetPasses& passes = performer.passes(target);
    SliceCache* cache = performer.slices();
    // An instance that is counted before its slice is built takes the ranges of the whole tree: then more tiles are
    // merged than need be.
    const std::optional<uint32_t> slice = !cache    ? std::nullopt
                                          : counted ? cache->find(instance.slice())
                                                    : cache->find_or_record(commands, instance.slice());
    if (!slice && !counted) record_rows(commands, performer.finder(), instance.frame);
    record_tile_ranges(commands, slice ? *passes.tree_ranger : *passes.direct_ranger, slice.value_or(0),
                       instance.rays.first_camera, instance.range_level, layout, counted);
    return slice;
}

}  // namespace

void record_sharing(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                    const ViewLayout& layout) {
    record_ranges(commands, performer, target, instance, layout, true);
}

void record_instance(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                     const ViewLayout& layout) {
    const TargetPasses& passes = performer.passes(target);
    const std::optional<uint32_t> slice = record_ranges(commands, performer, target, instance, layout, false);
    if (!slice) {
        record_direct_instance(commands, *passes.direct_tracers[static_cast<size_t>(instance.output)], instance.rays);
        return;
    }
    const Highlight* highlight = instance.highlight.get();
    if (highlight)
        record_bind_bones(commands, performer.bone_binder(), *slice, performer.slices()->build_of(*slice),
                          highlight->bones);
    const bool shaded = instance.shading == Shading::kPerLeaf;
    for (uint32_t view = 0; shaded && view < layout.views; ++view) {
        const RangeView& range = passes.target.views[instance.rays.first_camera + view];
        record_shade(commands, passes.per_leaf->shader, *slice, view, glm::vec3(range.eye));
        if (highlight) record_highlight(commands, *passes.highlighter, *slice, view, highlight->tints);
    }
    record_trace_tree(commands,
                      *passes.tree_tracers[TargetPasses::tree_tracer_index(instance.shading, instance.output)], *slice,
                      instance.rays);
}

}  // namespace neuvv::render
