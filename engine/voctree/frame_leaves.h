// What a clip shows at one of its frames, leaf by leaf: density, and colour as spherical harmonics, without bases.
#pragma once

#include <span>
#include <vector>

#include "voctree/slice_paint.h"
#include "voctree/temporal_basis.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

struct LiveLeaf {
    uint64_t cell = 0;   // Morton code of its first cell at depth 2 · node_levels
    uint32_t depth = 0;  // octree depth
    uint32_t leaf = 0;   // index into the tree
    float sigma = 0;     // 1/m
    float opacity = 0;   // along the mean of its edges: 1 − exp(−σ · edge)
};

// The leaves of a tree whose opacity is at least `least_opacity` at a time, under layers of paint, in order of their
// cells. `edits`: those of that time.
std::vector<LiveLeaf> live_leaves(const VOctree& tree, const RowsAtTime& rows, const FrameEdits& edits,
                                  float least_opacity);

// The colours of a leaf at a time under that paint: sigmoid(Σ k_lm Y_lm(d)) is linear light.
LeafColours leaf_colours(const VOctree& tree, uint32_t leaf, const RowsAtTime& rows, const FrameEdits& edits);

}  // namespace neuvv::voctree
