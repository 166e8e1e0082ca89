#include "voctree/voctree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "support/random_tree.h"

namespace neuvv {
namespace {

using test::Random;
using test::random_positions;
using test::random_tree;
using test::RandomTreeOptions;

bool same_position(const voctree::LeafPosition& a, const voctree::LeafPosition& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.depth == b.depth;
}

uint32_t find_leaf_by_search(const std::vector<voctree::LeafPosition>& positions, glm::dvec3 position) {
    for (uint32_t i = 0; i < positions.size(); ++i) {
        const voctree::LeafPosition& leaf = positions[i];
        const double cells = std::ldexp(1.0, static_cast<int>(leaf.depth));
        if (std::floor(position.x * cells) == leaf.x && std::floor(position.y * cells) == leaf.y &&
            std::floor(position.z * cells) == leaf.z)
            return i;
    }
    return UINT32_MAX;
}

voctree::VOctree tree_of(uint32_t node_levels, const std::vector<voctree::LeafPosition>& positions) {
    voctree::VOctree tree;
    tree.node_levels = node_levels;
    tree.bases = 2;
    tree.hh_degree = 0;
    tree.sigma_basis.assign(2, 0.5f);
    tree.gamma_basis.assign(2, 0.5f);
    voctree::build_topology(tree, positions);
    return tree;
}

TEST(Topology, CellsAreMortonNumbered) {
    // Depth 2 cell (x 2, y 1, z 3): high bits (1,0,1), low bits (0,1,1) → z1 y1 x1 z0 y0 x0 = 101 110.
    const voctree::VOctree even = tree_of(1, {{2, 1, 3, 2}});
    EXPECT_EQ(0u, even.nodes[0].mask_lo);
    EXPECT_EQ(1u << (0b101110 - 32), even.nodes[0].mask_hi);
    EXPECT_EQ(std::vector<uint32_t>{kLeafBit}, even.children);
    // Depth 1 octant (1,1,0) is byte 3 of the mask.
    const voctree::VOctree odd = tree_of(1, {{1, 1, 0, 1}});
    EXPECT_EQ(0xff000000u, odd.nodes[0].mask_lo);
    EXPECT_EQ(0u, odd.nodes[0].mask_hi);
    EXPECT_EQ(std::vector<uint32_t>(8, kLeafBit), odd.children);
}

TEST(Topology, EmptyTreeIsOneRoot) {
    const voctree::VOctree tree = tree_of(3, {});
    ASSERT_EQ(1u, tree.nodes.size());
    EXPECT_EQ(0u, tree.nodes[0].mask_lo | tree.nodes[0].mask_hi);
    EXPECT_TRUE(tree.children.empty());
    EXPECT_TRUE(voctree::leaf_positions(tree).empty());
    EXPECT_EQ(UINT32_MAX, voctree::find_leaf(tree, {0.5, 0.5, 0.5}));
    EXPECT_EQ("", voctree::defect_of(tree));
}

TEST(Topology, LeafPlacesInvertsBuildTopology) {
    for (uint64_t seed = 0; seed < 60; ++seed) {
        Random random(seed);
        const uint32_t levels = 1 + static_cast<uint32_t>(seed) % 3;
        const std::vector<voctree::LeafPosition> positions = random_positions(random, levels, 1 + random.below(600));
        const voctree::VOctree tree = tree_of(levels, positions);
        ASSERT_EQ("", voctree::defect_of(tree)) << seed;
        const std::vector<voctree::LeafPosition> found = voctree::leaf_positions(tree);
        ASSERT_EQ(positions.size(), found.size());
        for (size_t i = 0; i < positions.size(); ++i)
            ASSERT_TRUE(same_position(positions[i], found[i])) << seed << " " << i;
    }
}

TEST(Topology, GeneratorMixesAllDepths) {
    Random random(5);
    std::set<uint32_t> depths;
    for (const voctree::LeafPosition& position : random_positions(random, 3, 500)) depths.insert(position.depth);
    EXPECT_TRUE(depths.contains(3) && depths.contains(4) && depths.contains(5) && depths.contains(6));
    std::set<uint32_t> shallow;
    for (const voctree::LeafPosition& position : random_positions(random, 1, 12)) shallow.insert(position.depth);
    EXPECT_EQ((std::set<uint32_t>{1, 2}), shallow);
}

TEST(Topology, DeepestTreeReachesItsCorners) {
    const uint32_t last = (1u << (2 * kMaxNodeLevels)) - 1;
    const uint32_t depth = 2 * kMaxNodeLevels;
    const voctree::VOctree tree =
        tree_of(kMaxNodeLevels, {{last, last, last, depth}, {0, 0, 0, depth}, {last, 0, 7, depth}});
    EXPECT_EQ("", voctree::defect_of(tree));
    EXPECT_EQ(0u, voctree::find_leaf(tree, glm::dvec3(std::nextafter(1.0, 0.0))));
    EXPECT_EQ(1u, voctree::find_leaf(tree, {0, 0, 0}));
    EXPECT_EQ(2u, voctree::find_leaf(tree, {1 - 1e-6, 0, 7.5 / (last + 1)}));
    EXPECT_EQ(UINT32_MAX, voctree::find_leaf(tree, {1 - 1e-6, 0, 8.5 / (last + 1)}));
}

TEST(Topology, NodesAreBreadthFirst) {
    const voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 2000});
    uint32_t previous_first = 0, previous_node = 0;
    for (const TreeNode& node : tree.nodes) {
        EXPECT_GE(node.first_child, previous_first);
        previous_first = node.first_child;
    }
    for (const uint32_t entry : tree.children) {
        if (entry & kLeafBit) continue;
        EXPECT_EQ(previous_node + 1, entry);
        previous_node = entry;
    }
    EXPECT_EQ(tree.nodes.size(), previous_node + 1);
}

TEST(FindLeaf, AgreesWithASearchOverPlaces) {
    for (uint64_t seed = 0; seed < 30; ++seed) {
        Random random(100 + seed);
        const uint32_t levels = 1 + static_cast<uint32_t>(seed) % 3;
        const std::vector<voctree::LeafPosition> positions = random_positions(random, levels, 300);
        const voctree::VOctree tree = tree_of(levels, positions);
        size_t hits = 0;
        const double grid = std::ldexp(1.0, 2 * static_cast<int>(levels));
        for (int i = 0; i < 2000; ++i) {
            glm::dvec3 position(random.uniform(), random.uniform(), random.uniform());
            if (i % 2) position = glm::floor(position * grid) / grid;  // exactly on cell borders
            const uint32_t truth = find_leaf_by_search(positions, position);
            hits += truth != UINT32_MAX;
            ASSERT_EQ(truth, voctree::find_leaf(tree, position)) << seed;
        }
        EXPECT_GT(hits, 200u);
        EXPECT_LT(hits, 1800u);
    }
}

TEST(FindLeaf, OutsideTheBoxIsEmpty) {
    const voctree::VOctree tree = tree_of(1, {{0, 0, 0, 1}, {1, 1, 1, 1}});
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(0u, voctree::find_leaf(tree, {0, 0, 0}));
    for (const double outside : {-1e-9, 1.0, 1e30, -1e30, infinity, -infinity, std::nan("")})
        EXPECT_EQ(UINT32_MAX, voctree::find_leaf(tree, {0, outside, 0})) << outside;
}

// σ of the trees of random_tree, as its comment describes.
TEST(Generator, HalfOfTheLeavesAreVisible) {
    const voctree::VOctree tree = random_tree({.seed = 9, .node_levels = 3, .leaves = 3000, .bases = 8, .frames = 3});
    for (uint32_t frame = 0; frame < tree.frames; ++frame) {
        uint32_t visible = 0;
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            double sigma = 0;
            for (uint32_t i = 0; i < tree.bases; ++i)
                sigma += double{tree.sigma_basis[frame * tree.bases + i]} * double{tree.leaf(leaf)[i]};
            visible += sigma > 0;
        }
        EXPECT_NEAR(0.5, visible / static_cast<double>(tree.leaf_count), 0.1);
    }
}

// Each row damages a valid tree in one way and has a part of the expected message.
struct Damage {
    const char* word;
    void (*apply)(voctree::VOctree&);
};

TEST(Defect, EveryKindOfDamageIsNamed) {
    const Damage damages[] = {
        {"node_levels", [](voctree::VOctree& t) { t.node_levels = 0; }},
        {"node_levels", [](voctree::VOctree& t) { t.node_levels = 7; }},
        {"deeper", [](voctree::VOctree& t) { t.node_levels = 1; }},
        {"node count", [](voctree::VOctree& t) { t.nodes.clear(); }},
        {"bases", [](voctree::VOctree& t) { t.bases = 65; }},
        {"bases", [](voctree::VOctree& t) { t.bases = 0; }},
        {"hh_degree", [](voctree::VOctree& t) { t.hh_degree = 4; }},
        {"frames", [](voctree::VOctree& t) { t.frames = 0; }},
        {"frames", [](voctree::VOctree& t) { t.frames = voctree::kMaxFrames + 1; }},
        {"leaf count", [](voctree::VOctree& t) { t.leaf_count = voctree::kMaxLeaves + 1; }},
        {"leaves are not reached", [](voctree::VOctree& t) { ++t.leaf_count; }},
        {"out of range", [](voctree::VOctree& t) { --t.leaf_count; }},
        {"out of range", [](voctree::VOctree& t) { t.children[1] = static_cast<uint32_t>(t.nodes.size()); }},
        {"out of range", [](voctree::VOctree& t) { t.children[1] = UINT32_MAX; }},
        {"more than once", [](voctree::VOctree& t) { t.children[1] = 0; }},              // a cycle to the root
        {"more than once", [](voctree::VOctree& t) { t.children[1] = t.children[0]; }},  // a node with two parents
        {"more than once", [](voctree::VOctree& t) { t.children.back() = kLeafBit | 0; }},
        {"nodes are not reached",
         [](voctree::VOctree& t) {
             t.nodes.push_back({0, 0, 0, 0});
         }},
        {"child array", [](voctree::VOctree& t) { t.children.push_back(kLeafBit); }},
        {"beyond the child array", [](voctree::VOctree& t) { t.children.pop_back(); }},
        {"beyond the child array", [](voctree::VOctree& t) { t.nodes[2].first_child = UINT32_MAX; }},
        {"sigma basis", [](voctree::VOctree& t) { t.sigma_basis.pop_back(); }},
        {"gamma basis", [](voctree::VOctree& t) { t.gamma_basis[0] = std::numeric_limits<float>::infinity(); }},
        {"weights", [](voctree::VOctree& t) { t.weights.push_back(0); }},
        {"weights: number 3", [](voctree::VOctree& t) { t.weights[3] = std::nanf(""); }},
        {"box", [](voctree::VOctree& t) { t.box_size.y = 0; }},
        {"box", [](voctree::VOctree& t) { t.box_size.z = -1; }},
        {"box", [](voctree::VOctree& t) { t.box_size.x = 1e-40f; }},
        {"box", [](voctree::VOctree& t) { t.box_min.x = std::nanf(""); }},
        {"box", [](voctree::VOctree& t) { t.box_min.x = t.box_size.x = 3e38f; }},
        {"fps", [](voctree::VOctree& t) { t.fps = 0; }},
    };
    // Two nodes under the root (entries 0 and 1), each with one finest leaf, then a leaf of the root.
    const voctree::VOctree good = tree_of(2, {{0, 0, 0, 4}, {4, 0, 0, 4}, {1, 1, 1, 1}});
    ASSERT_EQ("", voctree::defect_of(good));
    ASSERT_EQ(1u, good.children[0]);
    ASSERT_EQ(2u, good.children[1]);
    for (const Damage& damage : damages) {
        voctree::VOctree tree = good;
        damage.apply(tree);
        EXPECT_NE(std::string::npos, voctree::defect_of(tree).find(damage.word))
            << damage.word << ": " << voctree::defect_of(tree);
    }
}

TEST(Defect, ARepeatedLeafMustFillOneWholeOctant) {
    // Seven cells of an octant, or eight cells across two octants, are not a leaf of the upper level.
    voctree::VOctree seven = tree_of(1, {{0, 0, 0, 1}});
    seven.nodes[0].mask_lo = 0x7f;
    seven.children.pop_back();
    EXPECT_NE("", voctree::defect_of(seven));
    voctree::VOctree straddling = tree_of(1, {{0, 0, 0, 1}});
    straddling.nodes[0].mask_lo = 0x0ff0;
    EXPECT_NE("", voctree::defect_of(straddling));
    voctree::VOctree twice = tree_of(1, {{0, 0, 0, 1}, {1, 0, 0, 1}});
    EXPECT_EQ("", voctree::defect_of(twice));
    std::fill(twice.children.begin() + 8, twice.children.end(), twice.children[0]);
    EXPECT_NE("", voctree::defect_of(twice));
    voctree::VOctree mixed = tree_of(1, {{0, 0, 0, 1}, {2, 0, 0, 2}});
    mixed.children[7] = mixed.children[8];
    EXPECT_NE("", voctree::defect_of(mixed));
    // Eight cells of an octant with eight different leaves are valid.
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < 8; ++i) positions.push_back({i & 1, i >> 1 & 1, i >> 2, 2});
    EXPECT_EQ("", voctree::defect_of(tree_of(1, positions)));
}

}  // namespace
}  // namespace neuvv
