// A person of leaves, without training: those around the bones of a skeleton.
#pragma once

#include "motion/skeleton/skeleton.h"
#include "voctree/voctree.h"

namespace neuvv::test {

// Each limb has a colour of its own, none of them red. Frame i shows the skeleton at i / fps seconds, and has a basis
// of its own; the space is the skeleton's. `frames` is at most 32. The body is about `kBodyCells` leaves tall.
voctree::VOctree body_tree(const motion::SkeletonClip& clip, uint32_t frames, float fps);

constexpr uint32_t kBodyDepth = 6, kBodyCells = 1u << kBodyDepth;

}  // namespace neuvv::test
