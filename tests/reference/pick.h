// Pick: the leaf in which a ray has gathered an alpha, and where in it.
#pragma once

#include <optional>

#include "reference/trace.h"

namespace neuvv::reference {

struct PickResult {
    uint32_t leaf = 0;
    double distance_m = 0;
};
// None where the ray gathers less.
std::optional<PickResult> pick(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                               double alpha);

}  // namespace neuvv::reference
