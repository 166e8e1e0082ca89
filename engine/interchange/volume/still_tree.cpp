#include "interchange/volume/still_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "voctree/sh_weights.h"
#include "voctree/slice_paint.h"

namespace neuvv::interchange {

namespace {

// The leaves in the order of their cells, without those that lie in one before them.
std::vector<size_t> sorted_without_overlaps(const StillLeaves& leaves, uint32_t depth) {
    std::vector<std::pair<uint64_t, size_t>> cells;
    cells.reserve(leaves.positions.size());
    for (size_t i = 0; i < leaves.positions.size(); ++i)
        cells.emplace_back(voctree::first_cell(leaves.positions[i], depth), i);
    std::sort(cells.begin(), cells.end(), [&](const auto& a, const auto& b) {
        const uint32_t depth_a = leaves.positions[a.second].depth, depth_b = leaves.positions[b.second].depth;
        return std::tie(a.first, depth_a, a.second) < std::tie(b.first, depth_b, b.second);
    });
    std::vector<size_t> order;
    order.reserve(cells.size());
    uint64_t end = 0;  // of the cells of the last leaf
    for (const auto& [cell, i] : cells) {
        if (cell < end) continue;
        end = cell + (uint64_t{1} << 3 * (depth - leaves.positions[i].depth));
        order.push_back(i);
    }
    return order;
}

}  // namespace

CellBox CellBox::around(const glm::ivec3& low, const glm::ivec3& high, int step, const std::string& file,
                        const Fix& hint) {
    CellBox box;
    int longest = 0;
    for (int i = 0; i < 3; ++i) {
        box.first[i] = low[i] & ~(step - 1);
        longest = std::max(longest, high[i] - box.first[i] + 1);
    }
    while (longest > 1 << box.depth) {
        box.depth += 2;
        if (box.depth > 2 * kMaxNodeLevels)
            throw InputError(file, "", fmt::format("has {} cells along one side; a clip has at most 4096", longest),
                             hint);
    }
    return box;
}

float constant_harmonic(float linear) {
    const float p = std::clamp(linear, kLeastImportedColour, 1 - kLeastImportedColour);
    return std::log(p / (1 - p)) / slice::kMeanHarmonic;
}

voctree::VOctree still_tree(const StillLeaves& leaves, const CellBox& box, const glm::dvec3& origin_m,
                            const glm::dvec3& cell_m, float fps) {
    voctree::VOctree tree;
    tree.box_min = glm::vec3(origin_m + glm::dvec3(box.first) * cell_m);
    tree.box_size = glm::vec3(cell_m * std::exp2(box.depth));
    tree.node_levels = box.depth / 2;
    tree.fps = fps;
    voctree::make_still(tree, leaves.degree);
    const std::vector<size_t> order = sorted_without_overlaps(leaves, box.depth);
    std::vector<voctree::LeafPosition> positions;
    positions.reserve(order.size());
    for (const size_t i : order) positions.push_back(leaves.positions[i]);
    voctree::build_topology(tree, positions);
    for (size_t i = 0; i < order.size(); ++i) {
        const float* from = &leaves.values[order[i] * leaves.values_of_leaf()];
        float* weights = tree.leaf(static_cast<uint32_t>(i));
        weights[0] = *from++;
        for (uint32_t c = 0; c < 3; ++c)
            voctree::write_sh(weights + 2 + c * hh_count(leaves.degree), leaves.degree,
                              from + c * sh_count(leaves.degree));
    }
    return tree;
}

}  // namespace neuvv::interchange
