#include "slice/slice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "slice/cell_code.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::slice {

glm::vec3 Slice::centre_m(const Leaf& leaf) const {
    const glm::uvec3 cell = cell_of(leaf.cell >> 3 * (depth - leaf.depth));
    return box_min + edges_m(leaf) * (glm::vec3(cell) + 0.5f);
}

float Slice::edge_m(const Leaf& leaf) const {
    return slice::edge_m(box_size, leaf.depth);
}

float Slice::opacity(const Leaf& leaf) const {
    return leaf.sigma > 0 ? 1 - std::exp(-optical_depth(leaf)) : 0;
}

uint32_t finest_depth(const Slice& slice) {
    uint32_t finest = 1;
    for (const Leaf& leaf : slice.leaves) finest = std::max(finest, leaf.depth);
    return finest;
}

namespace {

// Of one leaf. `end`: the cell behind the leaf before it.
std::string defect_of_leaf(const Slice& slice, const Leaf& leaf, uint64_t end) {
    if (leaf.depth < 1 || leaf.depth > slice.depth) return fmt::format("is at depth {} of {}", leaf.depth, slice.depth);
    const uint64_t cells = uint64_t{1} << 3 * (slice.depth - leaf.depth);
    if (leaf.cell % cells != 0 || leaf.cell >> 3 * slice.depth != 0) return "does not lie on a cell of its depth";
    if (leaf.cell < end) return "overlaps the one before it, or is not in order";
    if (!(leaf.sigma >= 0) || !std::isfinite(leaf.sigma)) return fmt::format("has a density of {}", leaf.sigma);
    for (const auto& channel : leaf.colours)
        if (!std::all_of(channel.begin(), channel.begin() + sh_count(slice.degree),
                         [](float k) { return std::isfinite(k); }))
            return "has a colour that is no number";
    return "";
}

}  // namespace

std::string defect_of(const Slice& slice) {
    if (slice.depth < 1 || slice.depth > stream::kMaxDepth) return fmt::format("has a depth of {}", slice.depth);
    if (slice.degree > kMaxHhDegree) return fmt::format("has harmonics of degree {}", slice.degree);
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(slice.box_min[axis]) || !std::isfinite(slice.box_size[axis]) || !(slice.box_size[axis] > 0))
            return "has no box";
    uint64_t end = 0;
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        const Leaf& leaf = slice.leaves[i];
        if (const std::string defect = defect_of_leaf(slice, leaf, end); !defect.empty())
            return fmt::format("leaf {} {}", i, defect);
        end = leaf.cell + (uint64_t{1} << 3 * (slice.depth - leaf.depth));
    }
    return "";
}

Slice scaled(Slice slice, double scale, const glm::dvec3& shift) {
    slice.box_min = glm::vec3(scale * glm::dvec3(slice.box_min) + shift);
    slice.box_size *= static_cast<float>(scale);
    for (Leaf& leaf : slice.leaves) {
        leaf.sigma /= static_cast<float>(scale);
        leaf.shown *= static_cast<float>(scale * scale);
    }
    return slice;
}

}  // namespace neuvv::slice
