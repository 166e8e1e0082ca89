// A made-up scene of any size, for measuring what large files cost.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::bench {

// A striped ball of 64 frames whose numbers differ from leaf to leaf so that they hardly pack: its .nvv has about
// `megabytes` MB. As few leaves as that allows: devices bound the texels of a buffer.
voctree::VOctree synthetic_scene(double megabytes);

}  // namespace neuvv::bench
