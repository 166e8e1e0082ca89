// Sibling leaves that look alike become one leaf, their parent: fewer leaves for the same image.
#pragma once

#include "training/slice_adjoint.h"
#include "voctree/voctree.h"

namespace neuvv::training {

// Merges each eight siblings whose parent would look like each of them, within `within`, in every frame that used one
// of them: in opacity over a sibling's edge; and, of those that the frame used, in linear light weighed by that
// opacity. The parent has the mean density of all and the colours of what was seen; the largest reach, every frame that
// used one of them, and no pull: where siblings agree, nothing is won by dividing. Returns how many families merged.
size_t merge_alike(voctree::VOctree& tree, LeafUse& use, float within);

}  // namespace neuvv::training
