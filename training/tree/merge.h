// Merges sibling leaves that look alike into one leaf, their parent: fewer leaves for the same image.
#pragma once

#include "training/tree/leaf_use.h"
#include "voctree/voctree.h"

namespace neuvv::training {

// Merges eight siblings where their parent would look like each of them in every frame that used one of them. Two
// differences may be at most `within`: that in opacity over a sibling's edge, and, for siblings that the frame used,
// that in linear light times this opacity.
//
// The parent has the mean density of all siblings and the mean colour of those that were seen. Its maximum weight is
// the largest of theirs, every frame that used one of them used it, and its opacity sensitivity is 0: where siblings
// agree, dividing again would gain nothing. `use` is that of the tree before and after. Returns how many families
// merged.
size_t merge_alike(voctree::VOctree& tree, LeafUse& use, float within);

}  // namespace neuvv::training
