#include "voctree/leaf_density.h"

#include <algorithm>
#include <cmath>

namespace neuvv::voctree {

std::vector<BasisEntry> basis_entries(const std::vector<float>& rows, uint32_t bases) {
    std::vector<BasisEntry> entries;
    for (size_t i = 0; i < rows.size(); i++)
        if (rows[i] != 0)
            entries.push_back({static_cast<uint32_t>(i / bases), static_cast<uint32_t>(i % bases), rows[i]});
    return entries;
}

void density_of_frames(const float* leaf, const std::vector<BasisEntry>& entries, std::vector<float>& sigma) {
    std::fill(sigma.begin(), sigma.end(), 0.0f);
    for (const BasisEntry& entry : entries) sigma[entry.frame] += entry.value * leaf[entry.basis];
    for (float& value : sigma) value = std::max(value, 0.0f);
}

float leaf_edge_m(const VOctree& tree, uint32_t depth) {
    const glm::vec3 size = tree.box_size;
    return std::ldexp((size.x + size.y + size.z) / 3, -static_cast<int>(depth));
}

}  // namespace neuvv::voctree
