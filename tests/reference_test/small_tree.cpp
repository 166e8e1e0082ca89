#include "reference_test/small_tree.h"

namespace neuvv::reference::test {
namespace {

void subdivide(Random& random, LeafPlace cell, uint32_t max_depth, std::vector<LeafPlace>& places) {
    if (cell.depth > 0 && random.below(4) == 0) return;  // empty
    if (cell.depth == max_depth || (cell.depth > 0 && random.below(3) == 0)) {
        places.push_back(cell);
        return;
    }
    for (uint32_t octant = 0; octant < 8; ++octant) {
        const LeafPlace child{cell.x * 2 + (octant & 1), cell.y * 2 + (octant >> 1 & 1), cell.z * 2 + (octant >> 2),
                              cell.depth + 1};
        subdivide(random, child, max_depth, places);
    }
}

// Does the coarser of two cells hold the finer one?
bool overlap(LeafPlace a, LeafPlace b) {
    const uint32_t shift_a = a.depth > b.depth ? a.depth - b.depth : 0;
    const uint32_t shift_b = b.depth > a.depth ? b.depth - a.depth : 0;
    return a.x >> shift_a == b.x >> shift_b && a.y >> shift_a == b.y >> shift_b && a.z >> shift_a == b.z >> shift_b;
}

// Fills node `index`, which stands at `corner`, from the leaves.
void build_node(VOctree& tree, const std::vector<LeafPlace>& places, uint32_t index, LeafPlace corner) {
    struct Child {
        LeafPlace cell;
        uint32_t leaf;  // UINT32_MAX: a node
    };
    std::vector<Child> children;
    uint64_t mask = 0;
    for (uint32_t i = 0; i < 64; ++i) {
        const LeafPlace cell{corner.x * 4 + (i >> 3 & 1) * 2 + (i & 1), corner.y * 4 + (i >> 4 & 1) * 2 + (i >> 1 & 1),
                             corner.z * 4 + (i >> 5 & 1) * 2 + (i >> 2 & 1), corner.depth + 2};
        for (uint32_t leaf = 0; leaf < places.size(); ++leaf) {
            if (!overlap(cell, places[leaf])) continue;
            mask |= uint64_t{1} << i;
            children.push_back({cell, places[leaf].depth <= cell.depth ? leaf : UINT32_MAX});
            break;
        }
    }
    const auto first = static_cast<uint32_t>(tree.children.size());
    tree.nodes[index] = {static_cast<uint32_t>(mask), static_cast<uint32_t>(mask >> 32), first, 0};
    tree.children.resize(first + children.size());
    for (uint32_t i = 0; i < children.size(); ++i) {
        if (children[i].leaf != UINT32_MAX) {
            tree.children[first + i] = children[i].leaf | kLeafBit;
            continue;
        }
        const auto node = static_cast<uint32_t>(tree.nodes.size());
        tree.children[first + i] = node;
        tree.nodes.emplace_back();
        build_node(tree, places, node, children[i].cell);
    }
}

std::vector<float> random_floats(Random& random, size_t count, double low, double high) {
    std::vector<float> values(count);
    for (float& v : values) v = static_cast<float>(random.uniform(low, high));
    return values;
}

}  // namespace

SmallTree random_small_tree(Random& random, uint32_t node_levels, uint32_t degree) {
    SmallTree small;
    subdivide(random, {0, 0, 0, 0}, 2 * node_levels, small.places);
    for (size_t i = small.places.size(); i > 1; --i) {
        std::swap(small.places[i - 1], small.places[random.below(static_cast<uint32_t>(i))]);
    }
    VOctree& tree = small.tree;
    tree.box_min = {-1.5f, 0.25f, -0.7f};
    tree.box_size = {2.0f, 1.3f, 1.7f};
    tree.node_levels = node_levels;
    tree.leaf_count = static_cast<uint32_t>(small.places.size());
    tree.bases = 3;
    tree.hh_degree = degree;
    tree.frames = 4;
    tree.nodes.resize(1);
    build_node(tree, small.places, 0, {0, 0, 0, 0});
    // Mostly positive, so that most leaves have density.
    tree.sigma_basis = random_floats(random, size_t{tree.frames} * tree.bases, 0.2, 1);
    tree.gamma_basis = random_floats(random, size_t{tree.frames} * tree.bases, -2, 2);
    tree.weights = random_floats(random, size_t{tree.leaf_count} * tree.weights_per_leaf(), -1, 2);
    return small;
}

uint32_t leaf_at(const std::vector<LeafPlace>& places, glm::dvec3 position_tree) {
    for (uint32_t leaf = 0; leaf < places.size(); ++leaf) {
        const LeafPlace& place = places[leaf];
        const glm::dvec3 p = position_tree * static_cast<double>(1u << place.depth);
        const glm::dvec3 low(place.x, place.y, place.z);
        if (glm::all(glm::lessThanEqual(low, p)) && glm::all(glm::lessThan(p, low + 1.0))) return leaf;
    }
    return UINT32_MAX;
}

}  // namespace neuvv::reference::test
