// A performer: one field on the device and the slices that are kept of it, drawn as often as it is placed. What it
// takes on the device does not grow with its instances.
#pragma once

#include <array>
#include <memory>

#include "render/shade.h"
#include "render/slice_cache.h"
#include "render/trace_tree.h"

namespace neuvv::render {

// A performer's place on stage and in its clip.
struct Instance {
    float frame = 0;                    // 0..frames−1, fractions allowed
    glm::mat4 world_from_performer{1};  // affine and invertible
    uint32_t paint = 0;                 // of its field's Paints; 0: none
    uint32_t field = 0;                 // of the renderer's
    float opacity = 1;                  // below 1 it lets light through, however dense it is (store_instance.glsl)
    bool casts_shadow = true, receives_shadow = true;
};

// Shading::kPerLeaf where that shows the same and is less work: where leaves are small, seen from the eye (performer's
// space, metres), on the average, and not far more than the view's `rays` of the rectangle around the field.
Shading play_shading(const Field& field, glm::vec3 eye, double rays);

// How an instance is drawn in one frame.
struct DrawnInstance {
    uint32_t field = 0;
    float frame = 0;
    uint32_t paint = 0;
    Shading shading = Shading::kPerRay;
    RayOutput output = RayOutput::kLayer;
    uint32_t range_level = 0;  // of nodes that tile ranges look at
    InstanceRays rays;
    SliceKey slice() const { return {frame, paint}; }
};

// The passes of one performer into one target, each made when first needed. All must outlive it.
struct TargetPasses {
    TargetPasses(const gpu::Device& device, const Field& field, const LiveLeaves& live, const SliceTrees* trees,
                 const RayTarget& target, uint32_t views);

    // Before an image. `segments`: bound where rays become those; null else.
    void ensure_tree_tracer(Shading shading, RayOutput output, const Segments* segments);
    void ensure_direct_tracer(RayOutput output, const Segments* segments);
    void ensure_direct_ranger();  // of the whole tree
    // The segments have other buffers now.
    void forget_segments();

    const gpu::Buffer* shaded() const { return per_leaf ? &per_leaf->entries : nullptr; }  // null before any was needed

    static size_t tree_tracer_index(Shading shading, RayOutput output);
    struct Shaded {
        gpu::Buffer entries;
        Shader shader;
        Shaded(const gpu::Device& device, const Field& field, const SliceTrees& trees, uint32_t views);
    };
    const gpu::Device& device;
    const Field& field;
    const LiveLeaves& live;
    const SliceTrees* trees;  // null: it has no slices
    const RayTarget& target;
    uint32_t views;
    std::unique_ptr<Shaded> per_leaf;
    std::unique_ptr<TileRanger> tree_ranger, direct_ranger;
    std::array<std::unique_ptr<TreeTracer>, 15> tree_tracers;
    std::array<std::unique_ptr<DirectTracer>, 5> direct_tracers;
};

// Of a budget of slices, the part of each of so many fields.
inline uint64_t slice_share(uint64_t budget, size_t fields) {
    return (budget + fields - 1) / fields;
}

class Performer {
  public:
    // A budget of 0 bytes: no slice at all, but one once a painted instance is drawn, as without a slice none shows its
    // paint; else one at least. All must outlive it.
    Performer(const gpu::Device& device, const Field& field, const Paints& paints, uint64_t slice_budget);

    // Where its instances are drawn, of so many views at most; returns the target's number.
    uint32_t add_target(const RayTarget& target, uint32_t views);
    // Another one by this number.
    void replace_target(uint32_t number, const RayTarget& target, uint32_t views);

    // Before an image is recorded: what its instances show in all targets, those first that shall rather have a slice,
    // and the slices that will be shown next. Then for each target its instances there; makes what is missing on the
    // device.
    void prepare(std::span<const SliceKey> slices, std::span<const SliceKey> next = {});
    void prepare(uint32_t target, const DrawnInstance& instance, const Segments* segments);
    // After it was waited for. True: a slice had more live leaves than there was room for; now there is more, and the
    // image must be prepared and recorded anew.
    bool enlarge_slices();
    void forget_segments();
    // Live leaves, and the live nodes above them, of the slices that the last image shows.
    uint64_t used_entries() const;

    const Field& field() const { return field_; }
    SliceCache* slices() { return slices_.get(); }  // null where there is none
    const SliceCache* slices() const { return slices_.get(); }
    const TargetPasses& passes(uint32_t target = 0) const { return *passes_[target]; }
    const LiveFinder& finder() const { return *finder_; }
    const gpu::Buffer& counts_readback() const { return counts_readback_; }

  private:
    void make_slices(uint32_t entries);
    void make_slices_for_paint(bool any_painted);
    const gpu::Device& device_;
    const Field& field_;
    const Paints& paints_;
    uint64_t slice_budget_;
    LiveLeaves live_;
    std::unique_ptr<LiveFinder> finder_;
    std::unique_ptr<SliceCache> slices_;
    gpu::Buffer counts_readback_;  // LiveCount of each slice as of the last image
    std::vector<std::pair<const RayTarget*, uint32_t>> targets_;
    std::vector<std::unique_ptr<TargetPasses>> passes_;  // by target
    size_t slice_paint_count_ = 0;                       // how many paints the slices were made for
};

// The slices of prepared instances.
void record_slices(gpu::Commands& commands, Performer& performer);
// After the image: so many parts (kSliceParts a slice) of those of the next frames.
void record_prefetch(gpu::Commands& commands, Performer& performer, uint32_t parts);

// One prepared instance of a group: counts it among those that share the tiles where it may be seen
// (record_clear_sharing).
void record_sharing(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                    const ViewLayout& layout);

// One prepared instance, into what earlier ones left in the target. Its slice is built now where it has no place of its
// own.
void record_instance(gpu::Commands& commands, Performer& performer, uint32_t target, const DrawnInstance& instance,
                     const ViewLayout& layout);

}  // namespace neuvv::render
