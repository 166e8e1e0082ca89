// Paint over a slice on the host (errata 14): what shaders/slice/paint_density.comp and paint_colour.comp do on the
// device.
#pragma once

#include <span>
#include <vector>

#include "shared/paint.h"
#include "slice/slice.h"
#include "voctree/edit_layer.h"

namespace neuvv::voctree {

// A visible layer, and how it is blended with those below it.
struct PaintStep {
    const EditLayer* layer = nullptr;
    uint32_t blend = kPaintNormal;  // kPaintNormal to kPaintRecolour
    float opacity = 1;
};

// The edits of layers that apply at one frame, found by leaf.
class FrameEdits {
  public:
    // `steps`: the lowest layer first; the layers must outlive it.
    FrameEdits(std::span<const PaintStep> steps, float frame);

    // The density of a leaf, 1/m, after those edits that change it.
    float painted_density(uint32_t leaf, float sigma) const;
    void paint_colours(uint32_t leaf, uint32_t degree, slice::Colours& k) const;

  private:
    struct Applied {
        uint32_t leaf;
        uint32_t blend;
        float opacity;
        const LeafEdit* edit;
    };
    std::span<const Applied> of_leaf(uint32_t leaf) const;
    std::vector<Applied> applied_;  // in order of leaf, those of a leaf from the lowest layer to the highest
};

}  // namespace neuvv::voctree
