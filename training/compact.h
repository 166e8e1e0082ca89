// What training leaves in a tree and no picture shows: taken out before the tree is written, so that the file packs
// well.
#pragma once

#include "voctree/voctree.h"

namespace neuvv {

// Rounds every weight: where each frame has a basis of its own, a leaf's colour moves by hundredths of linear light at
// most and its optical depth by 3 %; where frames share bases, weights by 1 %. Pixels are means of many leaves
// (RESULTS.md: what it costs). And, where each frame has a basis of its own (A and B are identities), zeroes w^σ and
// w^γ of frames in which a leaf is empty. A frame's picture stays as it was; between two frames a leaf that comes or
// goes does so over the whole of the interval.
void make_compact(VOctree& tree);

}  // namespace neuvv
