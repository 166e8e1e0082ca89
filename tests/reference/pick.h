// Pick: the leaf in which a ray's alpha reaches a threshold, and the distance where it does.
#pragma once

#include <optional>

#include "reference/trace.h"

namespace neuvv::reference {

struct PickResult {
    uint32_t leaf = 0;
    double distance_m = 0;
    glm::dvec3 colour{0};  // linear: what the ray sees down to there, divided by its alpha
};
// Nothing where the ray's alpha stays below `alpha`.
std::optional<PickResult> pick(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                               double alpha);

}  // namespace neuvv::reference
