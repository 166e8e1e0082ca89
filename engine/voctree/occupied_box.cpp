#include "voctree/occupied_box.h"

#include <cmath>
#include <limits>

namespace neuvv::voctree {

std::pair<glm::dvec3, glm::dvec3> occupied_box(const VOctree& tree) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const LeafPosition& position : leaf_positions(tree)) {
        const double edge = std::ldexp(1.0, -static_cast<int>(position.depth));
        const glm::dvec3 corner = glm::dvec3(position.x, position.y, position.z) * edge;
        low = glm::min(low, corner);
        high = glm::max(high, corner + edge);
    }
    if (tree.leaf_count == 0) {
        low = glm::dvec3(0);
        high = glm::dvec3(1);
    }
    const glm::dvec3 origin(tree.box_min), size(tree.box_size);
    return {origin + low * size, origin + high * size};
}

}  // namespace neuvv::voctree
