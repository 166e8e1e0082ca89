#include "reference/trace.h"

#include <gtest/gtest.h>

#include <map>

#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

struct TreeAndPlaces {
    voctree::VOctree tree;
    std::vector<voctree::LeafPosition> positions;  // by leaf index
};

TreeAndPlaces tree_and_places(uint64_t seed, uint32_t node_levels, uint32_t degree = 2) {
    TreeAndPlaces result;
    result.tree =
        neuvv::test::random_tree({.seed = seed, .node_levels = node_levels, .leaves = 300, .hh_degree = degree});
    result.positions = voctree::leaf_positions(result.tree);
    return result;
}

// The leaf at a tree-space position, or UINT32_MAX, by search over all positions, without the tree.
uint32_t leaf_at(const std::vector<voctree::LeafPosition>& positions, glm::dvec3 position_tree) {
    for (uint32_t leaf = 0; leaf < positions.size(); ++leaf) {
        const voctree::LeafPosition& position = positions[leaf];
        const glm::dvec3 p = position_tree * static_cast<double>(1u << position.depth);
        const glm::dvec3 low(position.x, position.y, position.z);
        if (glm::all(glm::lessThanEqual(low, p)) && glm::all(glm::lessThan(p, low + 1.0))) return leaf;
    }
    return UINT32_MAX;
}

glm::dvec3 world_of(const voctree::VOctree& tree, glm::dvec3 tree_position) {
    return glm::dvec3(tree.box_min) + tree_position * glm::dvec3(tree.box_size);
}

glm::dvec3 tree_of(const voctree::VOctree& tree, glm::dvec3 world) {
    return (world - glm::dvec3(tree.box_min)) / glm::dvec3(tree.box_size);
}

// A ray from around or inside the box through a point of the box.
Ray random_ray(Random& random, const voctree::VOctree& tree) {
    const glm::dvec3 target = world_of(tree, random_point(random, 0, 1));
    Ray ray;
    if (random.below(4) == 0) {
        ray.origin = world_of(tree, random_point(random, 0, 1));
        ray.direction = random_direction(random);
    } else {
        ray.origin = target + 4.0 * random_direction(random);
        ray.direction = glm::normalize(target - ray.origin);
    }
    if (random.below(3) == 0) ray.t_min = glm::length(target - ray.origin);
    return ray;
}

void expect_ordered_and_disjoint(const std::vector<LeafInterval>& intervals, double t_min) {
    double end = t_min;
    for (const LeafInterval& s : intervals) {
        EXPECT_GE(s.t_enter, end);
        EXPECT_GT(s.t_exit, s.t_enter);
        end = s.t_exit;
    }
}

// Compares with a search over all leaves at closely spaced points. Points that lie within rounding errors of a
// interval's end are ignored.
void expect_same_as_point_search(const TreeAndPlaces& small, const Ray& ray,
                                 const std::vector<LeafInterval>& intervals) {
    constexpr int kSteps = 3000;
    constexpr double kEnd = 9;  // metres: beyond every box from every origin
    const double step = (kEnd - ray.t_min) / kSteps;
    std::map<uint32_t, double> length_by_points, length_by_segments;
    size_t next = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double t = ray.t_min + (i + 0.5) * step;
        const uint32_t expected = leaf_at(small.positions, tree_of(small.tree, ray.origin + t * ray.direction));
        if (expected != UINT32_MAX) length_by_points[expected] += step;
        while (next < intervals.size() && intervals[next].t_exit <= t) ++next;
        const bool inside = next < intervals.size() && intervals[next].t_enter <= t;
        const bool near_end = (next < intervals.size() && std::abs(intervals[next].t_enter - t) < 1e-9) ||
                              (next > 0 && std::abs(intervals[next - 1].t_exit - t) < 1e-9) ||
                              (inside && std::abs(intervals[next].t_exit - t) < 1e-9);
        if (!near_end) {
            EXPECT_EQ(inside ? intervals[next].leaf : UINT32_MAX, expected) << "t = " << t;
        }
    }
    for (const LeafInterval& s : intervals) {
        EXPECT_EQ(length_by_segments.count(s.leaf), 0u) << "a convex leaf met twice";
        length_by_segments[s.leaf] = s.t_exit - s.t_enter;
    }
    for (const auto& [leaf, length] : length_by_segments) EXPECT_NEAR(length_by_points[leaf], length, 1.001 * step);
    for (const auto& [leaf, length] : length_by_points) EXPECT_EQ(length_by_segments.count(leaf), 1u);
}

TEST(Trace, SegmentsEqualAPointSearchOverAllLeaves) {
    Random random(1);
    size_t found = 0;
    for (int i = 0; i < 30; ++i) {
        const TreeAndPlaces small = tree_and_places(random.engine(), 1 + random.below(3));
        for (int j = 0; j < 6; ++j) {
            const Ray ray = random_ray(random, small.tree);
            const std::vector<LeafInterval> intervals = intersect(small.tree, ray);
            expect_ordered_and_disjoint(intervals, ray.t_min);
            expect_same_as_point_search(small, ray, intervals);
            found += intervals.size();
        }
    }
    EXPECT_GT(found, 300u);  // the test is not vacuous
}

TEST(Trace, AxisParallelRaysOnCellBordersStayInOneColumn) {
    Random random(2);
    size_t found = 0;
    for (int axis = 0; axis < 3; ++axis) {
        TreeAndPlaces small = tree_and_places(random.engine(), 2);
        // A power of two, so that the cells' borders have exact positions in the world.
        small.tree.box_min = glm::vec3(-1);
        small.tree.box_size = glm::vec3(2);
        for (const double border : {0.0, 0.25, 0.5, 0.8125}) {
            for (const double sign : {1.0, -1.0}) {
                Ray ray;
                ray.origin = world_of(small.tree, glm::dvec3(border));
                ray.origin[axis] = -3 * sign;
                ray.direction = glm::dvec3(0);
                ray.direction[axis] = sign;
                const std::vector<LeafInterval> intervals = intersect(small.tree, ray);
                found += intervals.size();
                expect_ordered_and_disjoint(intervals, 0);
                expect_same_as_point_search(small, ray, intervals);
            }
        }
    }
    EXPECT_GT(found, 20u);
}

TEST(Trace, AFullBoxIsCrossedWithoutGaps) {
    TreeAndPlaces small;
    small.tree.nodes = {{0xFFFFFFFFu, 0xFFFFFFFFu, 0, 0}};
    for (uint32_t i = 0; i < 64; ++i) small.tree.children.push_back(kLeafBit | i);
    small.tree.leaf_count = 64;
    Random random(3);
    size_t borders = 0;
    for (int i = 0; i < 200; ++i) {
        const Ray ray = random_ray(random, small.tree);
        const std::vector<LeafInterval> intervals = intersect(small.tree, ray);
        borders += intervals.empty() ? 0 : intervals.size() - 1;
        for (size_t j = 1; j < intervals.size(); ++j) EXPECT_EQ(intervals[j].t_enter, intervals[j - 1].t_exit);
    }
    EXPECT_GT(borders, 100u);
}

TEST(Trace, MissesGiveNothing) {
    Random random(4);
    const TreeAndPlaces small = tree_and_places(random.engine(), 1);
    const std::vector<LeafSlice> slices = slice_tree(small.tree, 0);
    Ray away{{0, 0, 9}, {0, 0, 1}, 0};
    EXPECT_TRUE(intersect(small.tree, away).empty());
    const RayResult r = trace(small.tree, slices, away);
    EXPECT_EQ(r.alpha, 0);
    EXPECT_TRUE(std::isinf(r.depth_m));
    EXPECT_TRUE(intersect(voctree::VOctree{}, away).empty());
}

TEST(Trace, SlicedEqualsDirect) {
    Random random(5);
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const TreeAndPlaces small = tree_and_places(random.engine(), 2, degree);
        const double frame = random.uniform(0, 3);
        const std::vector<LeafSlice> slices = slice_tree(small.tree, frame);
        double seen = 0;
        for (int i = 0; i < 20; ++i) {
            const Ray ray = random_ray(random, small.tree);
            const RayResult sliced = trace(small.tree, slices, ray);
            const RayResult direct = trace_direct(small.tree, frame, ray);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(sliced.colour[c], direct.colour[c], 1e-13);
            EXPECT_NEAR(sliced.alpha, direct.alpha, 1e-13);
            if (sliced.alpha > 0) {
                EXPECT_NEAR(sliced.depth_m, direct.depth_m, 1e-10);
            }
            seen += sliced.alpha;
        }
        EXPECT_GT(seen, 0.5);
    }
}

TEST(Trace, OneLeafByHand) {
    voctree::VOctree tree;
    tree.box_size = {1, 1, 4};  // a cell is 1 m deep
    tree.nodes = {{1, 0, 0, 0}};
    tree.children = {kLeafBit};
    tree.leaf_count = 1;
    std::vector<LeafSlice> slices(1);
    slices[0].sigma = std::log(2.0);
    const RayResult r = trace(tree, slices, {{0.1, 0.1, 5}, {0, 0, -1}, 0});
    EXPECT_NEAR(r.alpha, 0.5, 1e-15);
    EXPECT_NEAR(r.colour.x, 0.25, 1e-15);  // centre grey at half alpha
    EXPECT_NEAR(r.depth_m, 4.5, 1e-14);
    EXPECT_NEAR(trace(tree, slices, {{0.1, 0.1, 5}, {0, 0, -1}, 4.5}).depth_m, 4.75, 1e-14);
}

TEST(Trace, AdjointIsTheGradientOfEverySlice) {
    Random random(6);
    const TreeAndPlaces small = tree_and_places(random.engine(), 1);
    const voctree::VOctree& tree = small.tree;
    std::vector<LeafSlice> slices = slice_tree(tree, 1.25);
    for (LeafSlice& s : slices) s.sigma += 0.2;  // away from 0, where a density cannot be lowered
    size_t checked = 0;
    for (int i = 0; i < 10; ++i) {
        const Ray ray = random_ray(random, tree);
        const glm::dvec3 d_colour = random_point(random, -1, 1);
        const double d_alpha = random.uniform(-1, 1);
        const auto loss = [&] {
            const RayResult r = trace(tree, slices, ray);
            return glm::dot(d_colour, r.colour) + d_alpha * r.alpha;
        };
        for (const LeafSliceGradient& g : trace_adjoint(tree, slices, ray, d_colour, d_alpha)) {
            LeafSlice& s = slices[g.leaf];
            EXPECT_LT(gradient_error(g.sigma, s.sigma, loss), 1e-6);
            for (size_t c = 0; c < 3; ++c) {
                for (size_t k = 0; k < sh_count(2); ++k) {
                    EXPECT_LT(gradient_error(g.k[c][k], s.k[c][k], loss), 1e-6);
                }
            }
            ++checked;
        }
    }
    EXPECT_GT(checked, 10u);
}

}  // namespace
}  // namespace neuvv::reference::test
