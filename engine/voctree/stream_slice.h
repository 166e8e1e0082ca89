// Frames of a clip as slices of a stream, and back.
#pragma once

#include <span>

#include "stream/codec/quantised_slice.h"
#include "voctree/slice_paint.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// What the tree shows at a frame, or between two, under layers of paint, the lowest first, each made for this tree
// (assert): the leaves whose opacity along their edge is at least half of 1 / stream::kUnit.
stream::Slice slice_of(const VOctree& tree, double frame, std::span<const PaintStep> paint = {});

// The tree of one frame that shows the slice in a box, metres. Its leaves are in the order of the slice. The depth of
// the slice must be even (assert), and its opacities 0 to stream::kUnit.
VOctree tree_of(const stream::Slice& slice, glm::vec3 box_min, glm::vec3 box_size, float fps);

}  // namespace neuvv::voctree
