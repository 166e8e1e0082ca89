// Slices of trees, and trees of slices.
#pragma once

#include <span>

#include "slice/quantise.h"
#include "voctree/slice_paint.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// What the tree shows at a frame, or between two, under layers of paint, the lowest first, each made for this tree
// (assert): the leaves whose opacity along their edge is at least slice::kLeastOpacity. Each counts as shown as if
// nothing hid it.
slice::Slice slice_of(const VOctree& tree, double frame, std::span<const PaintStep> paint = {});

// The tree of one frame that shows the slice, which must have no defect_of; its depth must be even (assert). Its leaves
// are in the order of the slice.
VOctree tree_of(const slice::Slice& slice, float fps);

// Where the leaves of a stream's slice lie, in its order.
std::vector<LeafPosition> leaf_positions(const stream::QuantisedSlice& slice);

}  // namespace neuvv::voctree
