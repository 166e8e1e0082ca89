#include "reference/pick.h"

#include <algorithm>
#include <cmath>

namespace neuvv::reference {

std::optional<PickResult> pick(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                               double alpha) {
    double transmittance = 1;
    glm::dvec3 colour(0);
    for (const LeafInterval& interval : intersect(tree, ray)) {
        const double sigma = slices[interval.leaf].sigma;
        const double after = transmittance * std::exp(-sigma * (interval.t_exit - interval.t_enter));
        colour += (transmittance - std::max(after, 1 - alpha)) *
                  sample_colour(slices[interval.leaf], tree.hh_degree, ray.direction);
        if (after <= 1 - alpha)
            return PickResult{interval.leaf, interval.t_enter + std::log(transmittance / (1 - alpha)) / sigma,
                              colour / alpha};
        transmittance = after;
    }
    return std::nullopt;
}

}  // namespace neuvv::reference
