// A performer: one field on the device and the slices that are kept of it, drawn as often as it is placed. What it
// takes on the device does not grow with its instances.
#pragma once

#include <memory>

#include "render/shade.h"
#include "render/slice_cache.h"
#include "render/trace_tree.h"

namespace neuvv {

// A performer's place on stage and in its clip.
struct Instance {
    float frame = 0;                    // 0..frames−1, fractions allowed
    glm::mat4 world_from_performer{1};  // affine and invertible
    uint32_t paint = 0;                 // of its field's Paints; 0: none
};

// Shading::kPerLeaf where that shows the same and is less work: where leaves are small, seen from the eye (performer's
// space, metres), on the average, and not far more than the view's `rays` of the rectangle around the field.
Shading play_shading(const Field& field, glm::vec3 eye, double rays);

// How an instance is drawn in one frame.
struct DrawnInstance {
    float frame = 0;
    uint32_t paint = 0;
    Shading shading = Shading::kPerRay;
    uint32_t first_camera = 0;  // in ray batch and ranges
    uint32_t range_level = 0;   // of nodes that tile ranges look at
};

// By slices.
struct SlicePath {
    SlicePath(const Device& device, const Field& field, const LiveLeaves& live, const Paints& paints,
              const RayBatch& rays, const TileRanges& ranges, uint32_t views, uint32_t entries, uint64_t slice_budget);
    SliceCache cache;
    Buffer shaded;
    Shader shader;
    TileRanger ranger;
    TreeTracer unshaded_tracer, shaded_tracer;
    Buffer counts_readback;  // LiveCount of each slice as of the last picture
};

// By all numbers, where the budget has no room for a slice.
struct InstanceDirectPath {
    InstanceDirectPath(const Device& device, const Field& field, const LiveLeaves& live, const RayBatch& rays,
                       const TileRanges& ranges);
    LiveFinder finder;
    TileRanger ranger;
    DirectTracer tracer;
};

class Performer {
  public:
    // For at most so many views. All must outlive it. A budget of 0 bytes: no slice at all, but one once a painted
    // instance is drawn, as without a slice none shows its paint; else one at least.
    Performer(const Device& device, const Field& field, const Paints& paints, const RayBatch& rays,
              const TileRanges& ranges, uint32_t views, uint64_t slice_budget);

    // Before a picture is recorded: its instances, those first that shall rather have a slice, and the slices that will
    // be shown next. Makes what is missing on the device.
    void prepare(std::span<const DrawnInstance> instances, std::span<const SliceKey> next = {});
    // After it was waited for. True: a slice had more live leaves than there was room for; now there is more, and the
    // picture must be prepared and recorded anew.
    bool enlarge_slices();

    const Field& field() const { return field_; }
    const TileRanges& ranges() const { return ranges_; }
    SlicePath* slices() const { return slices_.get(); }  // null where there is none
    InstanceDirectPath* direct() const { return direct_.get(); }

  private:
    void make_slices(uint32_t entries);
    void make_room(bool any_painted);
    const Device& device_;
    const Field& field_;
    const Paints& paints_;
    const RayBatch& rays_;
    const TileRanges& ranges_;
    uint32_t views_;
    uint64_t slice_budget_;
    LiveLeaves live_;
    std::unique_ptr<SlicePath> slices_;
    std::unique_ptr<InstanceDirectPath> direct_;  // made when first needed
    std::vector<SliceKey> asked_;
    size_t paints_sliced_ = 0;  // how many paints the slices were made for
};

// The slices of prepared instances.
void record_slices(Commands& commands, Performer& performer);
// After the picture: so many parts (kSliceParts a slice) of those of the next frames.
void record_slices_ahead(Commands& commands, Performer& performer, uint32_t parts);

// One prepared instance, into what earlier ones left in the ray batch.
void record_instance(Commands& commands, const Performer& performer, const DrawnInstance& instance,
                     const ViewLayout& layout, float stop);

}  // namespace neuvv
