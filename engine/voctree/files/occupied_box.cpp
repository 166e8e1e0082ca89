#include "voctree/files/occupied_box.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace neuvv::voctree {

std::pair<glm::dvec3, glm::dvec3> occupied_box(const VOctree& tree) {
    return occupied_box(leaf_positions(tree), tree.box_min, tree.box_size);
}

std::pair<glm::dvec3, glm::dvec3> occupied_box(const std::vector<LeafPosition>& leaves, glm::vec3 box_min,
                                               glm::vec3 box_size) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const LeafPosition& position : leaves) {
        const double edge = std::ldexp(1.0, -static_cast<int>(position.depth));
        const glm::dvec3 corner = glm::dvec3(position.x, position.y, position.z) * edge;
        low = glm::min(low, corner);
        high = glm::max(high, corner + edge);
    }
    if (leaves.empty()) {
        low = glm::dvec3(0);
        high = glm::dvec3(1);
    }
    const glm::dvec3 origin(box_min), size(box_size);
    return {origin + low * size, origin + high * size};
}

}  // namespace neuvv::voctree
