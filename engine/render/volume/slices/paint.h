// Layers of paint on the device, and how they are applied to a slice while its tree is built (shared/paint.h, errata
// 14).
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "render/volume/slices/slice.h"
#include "shared/paint.h"
#include "stage/performer_settings.h"
#include "voctree/edit_layer.h"

namespace neuvv::render {

struct SliceTrees;

// Shaders know the blends by these numbers.
static_assert(static_cast<uint32_t>(stage::PaintBlend::kNormal) == kPaintNormal);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kMultiply) == kPaintMultiply);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kTint) == kPaintTint);
static_assert(static_cast<uint32_t>(stage::PaintBlend::kRecolour) == kPaintRecolour);

// A visible layer of a paint and how it is blended. Invisible layers are left out of a paint.
struct PaintUse {
    const voctree::EditLayer* layer = nullptr;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
};

// The layers of one performer: 20 bytes for each edit, and 8 for each leaf that has edits.
struct Paint {
    // `layers`: the lowest first; they are not needed afterwards. Throws RuntimeFailure for more than kPaintLayerLimit
    // layers, and for a layer of a field with another number of leaves than `field_leaves`.
    Paint(const gpu::Device& device, uint32_t field_leaves, std::span<const PaintUse> layers);

    uint32_t leaf_count;  // the leaves that have edits
    gpu::Buffer leaves, edits, sigmas, layers;
};

// The paints of the instances of one field. Each has a number, which is never used again; 0 means no paint. A paint
// never changes: where layers change there is a new paint, and slices with the old one stay valid.
class Paints {
  public:
    Paints(const gpu::Device& device, const Field& field) : device_(device), leaf_count_(field.leaf_count) {}
    // Creates a paint and returns its number. Throws RuntimeFailure as Paint does.
    uint32_t add(std::span<const PaintUse> layers) { return add(Paint(device_, leaf_count_, layers)); }
    // Adds a paint that was created for this field, and returns its number.
    uint32_t add(Paint paint) { return add(std::make_shared<const Paint>(std::move(paint))); }
    uint32_t add(const std::shared_ptr<const Paint>& paint);
    // No frame that uses the paint may be under way.
    void remove(uint32_t paint) { paints_.erase(paint); }
    // Null where there is no paint of this number.
    const Paint* find(uint32_t paint) const;
    size_t count() const { return paints_.size(); }

  private:
    const gpu::Device& device_;
    uint32_t leaf_count_;
    std::map<uint32_t, std::shared_ptr<const Paint>> paints_;
    uint32_t last_ = 0;
};

// The passes that apply paint to the slices of one field.
struct Painter {
    // Field, live leaves and trees must outlive it.
    Painter(const gpu::Device& device, const Field& field, const LiveLeaves& live, const SliceTrees& trees);

    const Field& field;
    const LiveLeaves& live;
    const SliceTrees& trees;
    gpu::ComputePass density, colour;
};

// A paint that is bound to the passes. Both must outlive it.
struct SlicePaint {
    SlicePaint(const Painter& passes, const Paint& layers);
    const Painter& painter;
    const Paint& paint;
    gpu::BindingSet density_set, colour_set;
};

// To be recorded after the densities of all leaves and before the nodes of the slice tree.
void record_paint_density(gpu::Commands& commands, const SlicePaint& paint, float frame);
// To be recorded after all entries of the slice tree.
void record_paint_colour(gpu::Commands& commands, const SlicePaint& paint, uint32_t slice, float frame);

}  // namespace neuvv::render
