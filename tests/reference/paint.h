// Paint: edits of leaves over a slice (errata 14).
#pragma once

#include <vector>

#include "reference/slice.h"
#include "shared/paint.h"
#include "voctree/edit_layer.h"

namespace neuvv::reference {

struct PaintStep {
    const voctree::EditLayer* layer = nullptr;
    uint32_t blend = kPaintNormal;
    double opacity = 1;
};

// The result of a layer over a colour where opacity and alpha are 1.
glm::dvec3 blend(uint32_t mode, glm::dvec3 colour, glm::dvec3 target);

// Applies layers, the lowest first, to slices (by leaf index) at a frame.
void paint(std::vector<LeafSlice>& slices, uint32_t degree, const std::vector<PaintStep>& steps, double frame);

}  // namespace neuvv::reference
