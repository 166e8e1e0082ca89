// Removes from a tree what training leaves in it and no image shows, so that the file packs well.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::training {

// Empties leaves in frames in which they are hardly visible: an optical depth over the leaf's edge of at most
// kThinDepth. Training keeps a little density in all leaves (schedule.h). Does nothing where frames share bases.
constexpr float kThinDepth = 0.1f;
// The density, in 1/m, at which a leaf of this depth is so thin.
inline float thin_sigma(const voctree::VOctree& tree, uint32_t depth) {
    return kThinDepth * static_cast<float>(1u << depth) / tree.box_size.x;
}
void empty_thin_leaves(voctree::VOctree& tree);

// Rounds every weight. Where each frame has its own basis, rounding changes a leaf's optical depth by 3 % and its
// colour by a few hundredths of linear light (compact_test.cpp measures them); where frames share bases, it changes
// weights by 1 %. Pixels are means of many leaves, so images change less.
//
// Where each frame has its own basis, w^σ and w^γ also become 0 in frames in which a leaf is empty. The image of a
// frame does not change by that. Between two frames, a leaf that appears or disappears now does so over the whole
// interval.
void make_compact(voctree::VOctree& tree);

}  // namespace neuvv::training
