// Rounds weights as coarsely as the images of a tree allow, because numbers with few digits pack into few bytes
// (pack.h).
#pragma once

#include "voctree/voctree.h"

namespace neuvv::voctree {

// The multiple of `step` that is nearest to `value`.
float rounded_to(float value, float step);

// Rounds each weight to multiples of the largest power of two for which this rounding alone changes the leaf in no
// frame by more than `error` (0 to 1). For w^σ that is the leaf's opacity along its edge, for w^γ and w^HH its colour
// in linear light times that opacity. So weights of leaves that are nearly transparent in the frames of a basis are
// rounded most. All weights must be finite.
void round_weights(VOctree& tree, float error);

}  // namespace neuvv::voctree
