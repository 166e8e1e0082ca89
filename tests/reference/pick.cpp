#include "reference/pick.h"

#include <cmath>

namespace neuvv::reference {

std::optional<PickResult> pick(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                               double alpha) {
    double transmittance = 1;
    for (const Segment& segment : intersect(tree, ray)) {
        const double sigma = slices[segment.leaf].sigma;
        const double after = transmittance * std::exp(-sigma * (segment.t_exit - segment.t_enter));
        if (after <= 1 - alpha)
            return PickResult{segment.leaf, segment.t_enter + std::log(transmittance / (1 - alpha)) / sigma};
        transmittance = after;
    }
    return std::nullopt;
}

}  // namespace neuvv::reference
