// Layers of paint on the device, and how they go over a slice while its tree is built (shared/paint.h, errata 14).
#pragma once

#include <map>

#include "render/slice.h"
#include "shared/paint.h"
#include "stage/performer_settings.h"
#include "voctree/paint.h"

namespace neuvv::render {

struct SliceTrees;

// Shaders have them by number.
static_assert(static_cast<uint32_t>(stage::PaintBlend::kNormal) == kPaintNormal);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kMultiply) == kPaintMultiply);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kTint) == kPaintTint);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kRecolour) == kPaintRecolour);

// A layer as it shows. Layers that do not show are left out of a paint.
struct PaintUse {
    const voctree::EditLayer* layer = nullptr;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
};

// The layers of one performer: 20 bytes an edit, 8 a leaf that has any.
struct Paint {
    // The lowest first; they are not needed afterwards. Throws RuntimeFailure for more than kPaintLayerLimit, and for
    // one that is not of a field of so many leaves.
    Paint(const gpu::Device& device, uint32_t field_leaves, std::span<const PaintUse> layers);

    uint32_t leaf_count;  // that have edits
    gpu::Buffer leaves, edits, sigmas, layers;
};

// What copies of one field are painted with, each paint by a number of its own that is not given twice: a paint does
// not change, and slices that were made with it need not be forgotten when layers do. 0 is no paint.
class Paints {
  public:
    Paints(const gpu::Device& device, const Field& field) : device_(device), leaf_count_(field.leaf_count) {}
    // Throws RuntimeFailure as Paint does.
    uint32_t add(std::span<const PaintUse> layers) { return add(Paint(device_, leaf_count_, layers)); }
    // One that was made for this field.
    uint32_t add(Paint paint);
    // No frame that shows it may be under way.
    void remove(uint32_t paint) { paints_.erase(paint); }
    // Null where there is none of this number.
    const Paint* find(uint32_t paint) const;
    size_t count() const { return paints_.size(); }

  private:
    const gpu::Device& device_;
    uint32_t leaf_count_;
    std::map<uint32_t, Paint> paints_;
    uint32_t last_ = 0;
};

// The passes for the slices of one field.
struct Painter {
    // Field, live leaves and trees must outlive it.
    Painter(const gpu::Device& device, const Field& field, const LiveLeaves& live, const SliceTrees& trees);

    const Field& field;
    const LiveLeaves& live;
    const SliceTrees& trees;
    gpu::ComputePass density, colour;
};

// A paint, bound to the passes. Both must outlive it.
struct SlicePaint {
    SlicePaint(const Painter& passes, const Paint& layers);
    const Painter& painter;
    const Paint& paint;
    gpu::BindingSet density_set, colour_set;
};

// After the densities of all leaves, before the nodes.
void record_paint_density(gpu::Commands& commands, const SlicePaint& paint, float frame);
// After all entries.
void record_paint_colour(gpu::Commands& commands, const SlicePaint& paint, uint32_t slice, float frame);

}  // namespace neuvv::render
