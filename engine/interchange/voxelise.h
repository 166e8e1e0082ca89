// Gaussian splats as a tree of cells.
#pragma once

#include <functional>

#include "interchange/splats.h"
#include "voctree/voctree.h"

namespace neuvv::interchange {

struct SplatBox {
    glm::dvec3 low{0}, high{0};  // metres
};
// A box around two deviations of all splats that can be seen; empty where there are none.
SplatBox box_of(const Splats& splats);

// A tree of one frame in whose cells, of `cell_m` or larger where splats are, light is dimmed as it is by the splats. A
// splat's density is that whose every line integral along its thinnest axis gives the splat's opacity there; in a cell,
// those of all splats are summed, and their colours averaged by density. Splats are widened by 0.3
// cells², as renderers widen them by 0.3 pixels². Splats and parts of them outside the box are
// left out. `between` is called now and then, from several threads, and may throw. Throws InputError with `file` where
// a tree would have too many cells.
voctree::VOctree voxelised(const Splats& splats, const SplatBox& box, double cell_m, float fps, const std::string& file,
                           const std::function<void()>& between);

}  // namespace neuvv::interchange
