// What training leaves in a tree and no image shows: taken out before the tree is written, so that the file packs
// well.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::training {

// Rounds every weight: where each frame has a basis of its own, a leaf's optical depth moves by 3 % and its colour by a
// few hundredths of linear light (compact_test.cpp measures them); where frames share bases, weights by 1 %. Pixels are
// means of many leaves (RESULTS.md: what it costs). And, where each frame has a basis of its own, zeroes w^σ and w^γ of
// frames in which a leaf is empty. A frame's image stays as it was; between two frames a leaf that comes or goes does
// so over the whole of the interval.
void make_compact(voctree::VOctree& tree);

// Takes out the leaves that are empty in every frame, where each frame has a basis of its own.
void drop_empty_leaves(voctree::VOctree& tree);

}  // namespace neuvv::training
