// A field on the device with its cached slices, drawn once for each of its instances: all performers of a stage that
// play the same clip are one Performer here. The device memory that it takes does not grow with their number.
#pragma once

#include <array>
#include <memory>

#include "render/volume/highlight.h"
#include "render/volume/pick.h"
#include "render/volume/shade.h"
#include "render/volume/slices/slice_cache.h"
#include "render/volume/tile_range.h"
#include "render/volume/trace_tree.h"

namespace neuvv::render {

// A performer's transform on the stage and its time in its clip.
struct Instance {
    float frame = 0;                    // 0..frames−1, fractions allowed
    glm::mat4 world_from_performer{1};  // affine and invertible
    uint32_t paint = 0;                 // number in its field's Paints; 0: none
    uint32_t field = 0;                 // index into the renderer's fields
    float opacity = 1;                  // below 1, light passes even its densest parts (store_instance.glsl)
    float density = 1;                  // above 0: what its densities are multiplied by, also in its shadows
    bool casts_shadow = true, receives_shadow = true;
    std::shared_ptr<const Highlight> highlight;  // null: none
    uint32_t performer = 0;                      // whose intervals of rays these are: of a stage, its index there
};

// Returns Shading::kPerLeaf where shading once a leaf looks the same as shading along each ray and is less work, else
// kPerRay. It looks the same where the average leaf is small, seen from `eye` (performer's space, metres). It is less
// work where the entries of a slice are fewer than about three times `rays`, the rays in the rectangle around the field
// in the view.
Shading play_shading(const Field& field, glm::vec3 eye, double rays);

// How an instance is drawn in one frame.
struct DrawnInstance {
    uint32_t field = 0;
    float frame = 0;
    uint32_t paint = 0;
    Shading shading = Shading::kPerRay;
    RayOutput output = RayOutput::kLayer;
    uint32_t range_level = 0;  // of the nodes that tile ranges are computed from
    InstanceRays rays;
    std::shared_ptr<const Highlight> highlight;  // only with Shading::kPerLeaf
    uint32_t performer = 0;                      // of the Instance
    SliceKey slice() const { return {frame, paint}; }
};

// The passes of one performer for one target. Each is created when it is first needed. All arguments must outlive it.
struct TargetPasses {
    TargetPasses(const gpu::Device& device, const Field& field, const LiveLeaves* live, const SliceTrees* trees,
                 const RayTarget& target, uint32_t views);

    // Create the passes for an instance, before an image is recorded. `intervals` must not be null where `output` is
    // kIntervals.
    void ensure_tree_tracer(Shading shading, RayOutput output, const Intervals* intervals);
    // After the tree tracer of an instance with a highlight.
    void ensure_highlighter(const BoneBinder& binder);
    void ensure_direct_tracer(RayOutput output, const Intervals* intervals);
    // The ranger for instances without a slice, which takes all leaves as live.
    void ensure_direct_ranger();
    // Drops the passes that are bound to the buffers of intervals: to be called before these are replaced.
    void forget_intervals();

    // Null as long as no instance was shaded a leaf.
    const gpu::Buffer* shaded() const { return per_leaf ? &per_leaf->entries : nullptr; }

    static size_t tree_tracer_index(Shading shading, RayOutput output);
    struct Shaded {
        gpu::Buffer entries;
        Shader shader;
        Shaded(const gpu::Device& device, const Field& field, const SliceTrees& trees, uint32_t views);
    };
    const gpu::Device& device;
    const Field& field;
    const LiveLeaves* live;   // null where the field came with its slice
    const SliceTrees* trees;  // null: the performer has no slices
    const RayTarget& target;
    uint32_t views;
    std::unique_ptr<Shaded> per_leaf;
    std::unique_ptr<Highlighter> highlighter;
    std::unique_ptr<TileRanger> tree_ranger, direct_ranger;
    std::array<std::unique_ptr<TreeTracer>, 15> tree_tracers;     // by tree_tracer_index: 3 shadings, 5 ray outputs
    std::array<std::unique_ptr<DirectTracer>, 5> direct_tracers;  // by RayOutput
};

// The share of each field in a budget of bytes for slices.
inline uint64_t slice_share(uint64_t budget, size_t fields) {
    return (budget + fields - 1) / fields;
}

// The share of one of a field's far levels, beside that of the field itself: as much for each leaf.
inline uint64_t slice_share_of_level(uint64_t field_share, const Field& field, const Field& level) {
    if (field_share == 0) return 0;
    const double part = static_cast<double>(level.leaf_count) / field.leaf_count;
    return std::max(static_cast<uint64_t>(part * static_cast<double>(field_share)), uint64_t{1});
}

class Performer {
  public:
    // A budget of 0 bytes means no slice, except for a single one as soon as a painted instance is drawn, because paint
    // cannot be drawn without a slice. Any other budget has at least one slice. A field that came with its slice
    // has that. All arguments must outlive it.
    Performer(const gpu::Device& device, const Field& field, const Paints& paints, uint64_t slice_budget);

    // Adds a target for its instances, with at most `views` views. Returns the target's number.
    uint32_t add_target(const RayTarget& target, uint32_t views);
    // Gives the number to another target.
    void replace_target(uint32_t index, const RayTarget& target, uint32_t views);

    // Before an image is recorded, first the slices of its instances in all targets are requested, the most important
    // first, and the slices of the next images (`next`, to be prefetched). Then the second function is called for each
    // instance of each target. Both create on the device what is missing.
    void prepare(std::span<const SliceKey> slices, std::span<const SliceKey> next = {});
    void prepare(uint32_t target, const DrawnInstance& instance, const Intervals* intervals);
    // Whether prepare() would replace slices that images under way read, if it were given these.
    bool replaces_slices(std::span<const SliceKey> slices) const;
    // Whether a slice had more entries than there was room for in an image that is finished, by its slot. Then the
    // slices need more room, and the image must be prepared and recorded again. No image may be under way.
    bool overflowed(uint32_t slot) const;
    void enlarge_slices();
    void forget_intervals();
    // The number of live leaves and of live nodes above them, in the slices that the last image used; `slot` is that of
    // an image that is finished.
    uint64_t used_entries(uint32_t slot) const;

    // Something that picks in slices() and does not do so yet. It exists until the slices are made anew.
    SlicePicker& idle_picker();

    const Field& field() const { return field_; }
    SliceCache* slices() { return slices_.get(); }  // null without slices
    const SliceCache* slices() const { return slices_.get(); }
    const TargetPasses& passes(uint32_t target = 0) const { return *passes_[target]; }
    const LiveFinder& finder() const { return *finder_; }
    BoneBinder& bone_binder() { return *bone_binder_; }  // exists where an instance with a highlight was prepared
    const gpu::Buffer& counts_readback(uint32_t slot) const { return counts_readback_[slot]; }

  private:
    void make_live(uint32_t slots);
    void make_slices(uint32_t entries);
    std::unique_ptr<TargetPasses> make_passes(const RayTarget& target, uint32_t views) const;
    void make_slices_for_paint(bool are_painted);
    const gpu::Device& device_;
    const Field& field_;
    const Paints& paints_;
    uint64_t slice_budget_;
    std::unique_ptr<LiveLeaves> live_;  // null where the field came with its slice, as is finder_
    std::unique_ptr<LiveFinder> finder_;
    std::unique_ptr<SliceCache> slices_;
    std::unique_ptr<BoneBinder> bone_binder_;
    std::vector<std::unique_ptr<SlicePicker>> pickers_;         // created when first needed
    std::array<gpu::Buffer, kImagesUnderWay> counts_readback_;  // by slot: LiveCount of each slice
    std::vector<std::pair<const RayTarget*, uint32_t>> targets_;
    std::vector<std::unique_ptr<TargetPasses>> passes_;  // by target
    size_t slice_paint_count_ = 0;                       // the number of paints for which there is room
};

// Builds the slices of the prepared instances.
void record_slices(gpu::Commands& commands, Performer& performer);
// To be recorded after the image: builds `parts` parts of the slices of the next images (a slice has kSliceParts). The
// host reads in the image's slot how many entries slices have.
void record_prefetch(gpu::Commands& commands, Performer& performer, uint32_t parts, uint32_t slot);

// Counts a prepared instance of a group in TileRanges::sharing, for each tile that it may cover.
void record_sharing(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                    const ViewLayout& layout);

// Traces one prepared instance and combines it with what earlier instances left in the target. Where painted slices
// share memory (SliceCache), its slice is built first.
void record_instance(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                     const ViewLayout& layout);

}  // namespace neuvv::render
