// A layer of paint on a field: what leaves shall look like instead, and when (errata 14). Layers lie beside the shared
// weights, so that copies of one field are painted each for itself. How a layer shows (its blend, its opacity) is said
// where it is used.
#pragma once

#include <span>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// The field that paint was made for: its leaves by number, its clip by frames.
struct PaintedField {
    uint64_t topology = 0;  // XXH3-64 of levels, nodes and children
    uint32_t leaf_count = 0;
    uint32_t frames = 1;
    bool operator==(const PaintedField&) const = default;
};
PaintedField painted_field(const VOctree& tree);

constexpr float kKeepSigma = -1;

struct LeafEdit {
    uint32_t leaf = 0;
    float first = 0, last = 0;  // frames, both within: it holds where first <= t <= last
    glm::vec3 colour{0};        // target, linear RGB of 0 to 1
    float alpha = 0;            // how much of it; 0: the colour stays
    float sigma = kKeepSigma;   // target, 1/m; 0 erases; kKeepSigma: the density stays
    bool operator==(const LeafEdit&) const = default;
};

// In order of leaf and first frame; of one leaf, no two edits hold at the same time.
struct EditLayer {
    PaintedField field;
    std::vector<LeafEdit> edits;
};

// Later edits go over earlier ones, those of the layer before all: where both hold, alpha covers (a whole one
// replaces), and a density replaces; elsewhere the earlier stays as it is. Edits must be sound but for their order.
void add_edits(EditLayer& layer, std::span<const LeafEdit> edits);

// Takes out what holds on these leaves (in any order) between two frames, both within.
void remove_edits(EditLayer& layer, std::span<const uint32_t> leaves, float first, float last);

// What is wrong with a layer, or an empty string: numbers out of range, edits out of order or over each other.
std::string defect_of(const EditLayer& layer);

}  // namespace neuvv::voctree
