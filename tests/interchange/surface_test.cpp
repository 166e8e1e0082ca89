// Surfaces of volumes whose shape is known: closed, of the right size, also where leaves of two sizes meet.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "interchange/mesh/simplify.h"
#include "interchange/mesh/surface_net.h"
#include "support/closed_mesh.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using interchange::LeafGrid;
using interchange::TriangleMesh;

constexpr float kOpaque = 1e5f;  // 1/m
const glm::vec3 kCentreOfBall(0.5f);

TriangleMesh surface_of(const slice::Slice& volume, double opacity = 0.5) {
    return interchange::surface_of(interchange::solid_of(LeafGrid(volume), opacity));
}

std::function<bool(glm::vec3)> ball(float radius, const glm::vec3& centre = kCentreOfBall) {
    return [=](const glm::vec3& p) { return glm::distance(p, centre) < radius; };
}

double ball_m3(double radius) {
    return 4.0 / 3 * std::numbers::pi * radius * radius * radius;
}

TEST(Surface, OfABallIsABall) {
    const slice::Slice volume = volume_of(5, kOpaque, ball(0.3f));
    const TriangleMesh mesh = surface_of(volume);
    EXPECT_EQ(expect_closed(mesh), 2);
    // 0.01 of a radius of ten cells is a tenth of a cell.
    EXPECT_NEAR(std::cbrt(enclosed_m3(mesh) / ball_m3(0.3)), 1, 0.01);
    EXPECT_NEAR(std::cbrt(enclosed_m3(mesh) * 32768 / static_cast<double>(volume.leaves.size())), 1, 0.01);
    const std::vector<glm::vec3> normals = interchange::normals_of(mesh);
    for (size_t i = 0; i < normals.size(); ++i) {
        EXPECT_NEAR(glm::distance(mesh.positions[i], kCentreOfBall), 0.3f, 1.0f / 32);
        EXPECT_GT(glm::dot(normals[i], glm::normalize(mesh.positions[i] - kCentreOfBall)), 0.8f);
    }
}

TEST(Surface, OfACubeIsACube) {
    const auto cube = [](const glm::vec3& p) {
        return glm::all(glm::greaterThan(p, glm::vec3(0.25f))) && glm::all(glm::lessThan(p, glm::vec3(0.75f)));
    };
    const TriangleMesh mesh = surface_of(volume_of(5, kOpaque, cube));
    EXPECT_EQ(expect_closed(mesh), 2);
    EXPECT_NEAR(enclosed_m3(mesh), 0.125, 0.004);
    size_t flat = 0;
    for (const glm::vec3& p : mesh.positions) {
        EXPECT_TRUE(glm::all(glm::greaterThan(p, glm::vec3(0.245f))) && glm::all(glm::lessThan(p, glm::vec3(0.755f))));
        if (std::abs(p.y - 0.75f) < 1e-4f) ++flat;  // what smoothing of the edges does not reach
    }
    EXPECT_GE(flat, 9u * 9) << "the faces are where the leaves end";
}

// Coarse leaves on the left, fine ones on the right, of one block.
TEST(Surface, HasNoCrackBetweenLeavesOfTwoSizes) {
    slice::Slice volume;
    volume.depth = 5;
    const auto block = [](const glm::vec3& p) {
        return glm::all(glm::greaterThan(p, glm::vec3(0.25f))) && glm::all(glm::lessThan(p, glm::vec3(0.75f)));
    };
    add_leaves(volume, 3, kOpaque, [&](const glm::vec3& p) { return block(p) && p.x < 0.5f; });
    add_leaves(volume, 5, kOpaque, [&](const glm::vec3& p) { return block(p) && p.x > 0.5f; });
    const TriangleMesh mesh = surface_of(volume);
    EXPECT_EQ(expect_closed(mesh), 2);
    EXPECT_NEAR(enclosed_m3(mesh), 0.125, 0.004);
}

TEST(Surface, IsWhereARayGetsTheOpacity) {
    constexpr float kCell = 1.0f / 64;
    const slice::Slice volume = volume_of(6, std::log(2.0f) / (8 * kCell), ball(0.4f));
    const auto radius = [&](double opacity) {
        return std::cbrt(enclosed_m3(surface_of(volume, opacity)) / ball_m3(1));
    };
    // Half after 8 cells, of which the last two may lie behind the surface, by rays up to 55° aslant.
    EXPECT_LT(radius(0.5), 0.4 - 3 * double{kCell});
    EXPECT_GT(radius(0.5), 0.4 - 6 * double{kCell});
    EXPECT_LT(radius(0.75), radius(0.5) - 5 * double{kCell});
    EXPECT_GT(radius(0.1), 0.4 - double{kCell});
}

// Through a hole in a hollow ball one sees its inside along a single line; loose leaves float there.
TEST(Surface, LeavesOutWhatIsHidden) {
    const slice::Slice volume = volume_of(5, kOpaque, [](const glm::vec3& p) {
        const float radius = glm::distance(p, kCentreOfBall);
        const bool hole = p.x > 0.5f && std::abs(p.y - 0.484375f) < 0.01f && std::abs(p.z - 0.484375f) < 0.01f;
        return radius < 0.1f || (radius > 0.32f && radius < 0.4f && !hole);
    });
    const TriangleMesh mesh = surface_of(volume);
    EXPECT_EQ(expect_closed(mesh), 2);
    EXPECT_NEAR(enclosed_m3(mesh) / ball_m3(0.4), 1, 0.02);
    for (const glm::vec3& p : mesh.positions) EXPECT_GT(glm::distance(p, kCentreOfBall), 0.33f) << "the hole is closed";
}

// Three thin holes that cross in the centre, which is seen through all of them.
TEST(Surface, HasNoCavities) {
    const slice::Slice volume = volume_of(5, kOpaque, [](const glm::vec3& p) {
        const glm::bvec3 in_line = glm::lessThan(glm::abs(p - 0.484375f), glm::vec3(0.01f));
        const int lines = (in_line.x ? 1 : 0) + (in_line.y ? 1 : 0) + (in_line.z ? 1 : 0);
        return lines < 2 && ball(0.4f)(p);
    });
    EXPECT_EQ(expect_closed(surface_of(volume)), 2);
}

// Cells that meet in edges and corners alone.
TEST(Surface, IsAManifoldWhateverCellsThereAre) {
    Random random(5);
    for (int i = 0; i < 20; ++i) {
        const double share = 0.02 + 0.03 * i;
        expect_closed(surface_of(volume_of(3, kOpaque, [&](const glm::vec3&) { return random.uniform() < share; })));
    }
    const slice::Slice corners =
        volume_of(2, kOpaque, [](const glm::vec3& p) { return p == glm::vec3(0.375f) || p == glm::vec3(0.625f); });
    EXPECT_EQ(expect_closed(surface_of(corners)), 2) << "they are joined";
}

TEST(Surface, OfNothingIsNothing) {
    EXPECT_TRUE(surface_of(volume_of(3, kOpaque, [](const glm::vec3&) { return false; })).triangles.empty());
    EXPECT_TRUE(surface_of(volume_of(3, 1e-3f, [](const glm::vec3&) { return true; })).triangles.empty());
}

TEST(LeafGrid, MergesLeavesWhereItWouldBeTooLarge) {
    const slice::Slice volume = volume_of(5, 100, ball(0.3f));
    const LeafGrid grid(volume, 5000);
    EXPECT_EQ(grid.volume().depth, 4u);
    EXPECT_FLOAT_EQ(grid.cell_m().x, 1.0f / 16);
    ASSERT_NE(grid.leaf_at(kCentreOfBall), nullptr);
    EXPECT_FLOAT_EQ(grid.leaf_at(kCentreOfBall)->sigma, 100);
    EXPECT_EQ(grid.leaf_at({0.1f, 0.5f, 0.5f}), nullptr);
    EXPECT_EQ(grid.leaf_at({9, 9, 9}), nullptr);
}

TEST(Simplify, KeepsShapeAndTopology) {
    const TriangleMesh ball_mesh = surface_of(volume_of(6, kOpaque, ball(0.4f)));
    const TriangleMesh few = interchange::simplified(ball_mesh, 400);
    EXPECT_LE(few.triangles.size(), 400u);
    EXPECT_GT(few.triangles.size(), 390u);
    EXPECT_EQ(expect_closed(few), 2);
    EXPECT_NEAR(enclosed_m3(few) / ball_m3(0.4), 1, 0.03);
    const TriangleMesh ring = surface_of(volume_of(5, kOpaque, [](const glm::vec3& p) {
        return glm::distance(glm::vec2(glm::length(glm::vec2(p.x, p.y) - 0.5f) - 0.3f, p.z - 0.5f), glm::vec2(0)) <
               0.1f;
    }));
    EXPECT_EQ(expect_closed(ring), 0);
    EXPECT_EQ(expect_closed(interchange::simplified(ring, 100)), 0);
    EXPECT_EQ(expect_closed(interchange::simplified(ring, 4)), 0) << "it stops before it loses the hole";
    Random random(2);
    const TriangleMesh rough =
        surface_of(volume_of(4, kOpaque, [&](const glm::vec3&) { return random.uniform() < 0.2; }));
    const int euler = expect_closed(rough);
    EXPECT_EQ(expect_closed(interchange::simplified(rough, rough.triangles.size() / 4)), euler);
}

TEST(TriangleMesh, DropsSmallParts) {
    const slice::Slice volume = volume_of(
        5, kOpaque, [](const glm::vec3& p) { return ball(0.25f)(p) || glm::distance(p, glm::vec3(0.9f)) < 0.03f; });
    const TriangleMesh both = surface_of(volume);
    EXPECT_EQ(expect_closed(both), 4);
    EXPECT_EQ(expect_closed(interchange::without_small_parts(both, 0)), 4);
    const TriangleMesh one = interchange::without_small_parts(both, 0.2);
    EXPECT_EQ(expect_closed(one), 2);
    EXPECT_NEAR(enclosed_m3(one) / ball_m3(0.25), 1, 0.03);
}

}  // namespace
}  // namespace neuvv::test
