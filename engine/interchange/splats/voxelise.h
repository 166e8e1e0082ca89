// Gaussian splats as a tree of cells.
#pragma once

#include <functional>

#include "interchange/splats/splat_box.h"
#include "voctree/voctree.h"

namespace neuvv::interchange {

// A tree of one frame that dims light as the splats do. Its cells are `cell_m` wide, or wider where all splats are
// large. Each splat becomes a density: a ray along its thinnest axis is dimmed by just the opacity that the splat has
// where the ray passes. A cell has the sum of the densities in it, and the mean of the colours, weighted by density.
// Splats are widened by 0.3 cells², as renderers widen them by 0.3 pixels². What lies outside the box is left out.
// `between` is called now and then, from several threads, and may throw. Throws InputError with `file` and a splat
// where a tree would have too many cells.
voctree::VOctree voxelised(const Splats& splats, const SplatBox& box, double cell_m, float fps, const std::string& file,
                           const std::function<void()>& between);

}  // namespace neuvv::interchange
