// Weights on grids as coarse as images allow: numbers with few digits pack into few bytes (pack.h).
#pragma once

#include "voctree/voctree.h"

namespace neuvv::voctree {

// The multiple of `step` that is nearest.
float rounded_to(float value, float step);

// Rounds every weight to the coarsest power of two by which it alone moves what its leaf shows, in any frame, by at
// most `error` (0 to 1): the leaf's opacity over its edge (w^σ), its colour in linear light times that opacity (w^γ,
// w^HH). What is hidden in frames that a basis has a part in is rounded most. All weights must be finite.
void round_weights(VOctree& tree, float error);

}  // namespace neuvv::voctree
