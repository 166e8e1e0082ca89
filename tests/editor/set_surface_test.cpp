// Where rays meet a set: against every triangle in the world, one after the other.
#include "editor/draw/set_surface.h"

#include <gtest/gtest.h>

#include <random>

#include "support/set_scene.h"

namespace neuvv::test {
namespace {

using editor::SetSurface;

// Where a ray meets a triangle: where it crosses the plane, if that point is on the same side of all edges.
double crossing(const Ray& ray, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double metres = glm::dot(a - ray.origin, normal) / glm::dot(ray.direction, normal);
    const glm::dvec3 at = ray.origin + metres * ray.direction;
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
        if (!(glm::dot(glm::cross(to - from, at - from), normal) >= 0)) return INFINITY;
    return metres > 0 ? metres : INFINITY;
}

editor::SetHit nearest_of_all(const stage::GltfScene& scene, const stage::PosedScene& pose, const Ray& ray) {
    editor::SetHit nearest{0, INFINITY};
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
        if (!scene.nodes[node].draws_mesh()) continue;
        for (const auto& primitive : scene.meshes[static_cast<size_t>(scene.nodes[node].mesh)].primitives) {
            stage::PosedVertices posed;
            stage::pose_vertices(scene, pose, node, primitive, posed);
            for (size_t i = 0; i < primitive.indices.size(); i += 3) {
                const double metres =
                    crossing(ray, posed.positions[primitive.indices[i]], posed.positions[primitive.indices[i + 1]],
                             posed.positions[primitive.indices[i + 2]]);
                if (metres < nearest.distance_m) nearest = {node, metres};
            }
        }
    }
    return nearest;
}

// Balls and a wall, placed by all kinds of transforms; the last ball is morphed.
stage::GltfScene some_set() {
    GlbBuilder glb;
    add_mesh(glb, sphere({0, 0, 0}, 0.5f, 24))["translation"] = {1, 0.5, -2};
    add_mesh(glb, rectangle({-2, 0, -4}, {4, 0, 0}, {0, 3, 0}));
    json& mirrored = add_mesh(glb, sphere({0, 0, 0}, 0.5f, 9));
    mirrored["translation"] = {-1, 1, -1.5};
    mirrored["scale"] = {-1, 2, 0.25};
    mirrored["rotation"] = {0, 0.6, 0, 0.8};
    json& flattened = add_mesh(glb, sphere({0, 0, 0}, 0.4f, 6));  // to a disk; its transform has no inverse
    flattened["scale"] = {1, 0, 1};
    flattened["translation"] = {0.8, 1.4, -1};
    const MeshData ball = sphere({0, 0, 0}, 0.4f, 8);
    add_mesh(glb, ball)["translation"] = {0, 2, -2};
    glb.root["meshes"].back()["primitives"][0]["targets"] = {{{"POSITION", glb.vec3(ball.positions)}}};
    glb.root["meshes"].back()["weights"] = {0.5};
    glb.root["scenes"] = {{{"nodes", {0, 1, 2, 3, 4}}}};
    glb.root["scene"] = 0;
    return scene_of(glb);
}

void expect_rays_meet(const SetSurface& set, const stage::GltfScene& scene, const stage::PosedScene& pose) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> some(-1, 1);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 from(some(random), 1 + some(random), some(random)),
            to(2 * some(random), 1 + some(random), -2 + some(random));
        const Ray ray{from, glm::normalize(to - from)};
        const editor::SetHit truth = nearest_of_all(scene, pose, ray);
        const auto hit = set.meet(ray);
        ASSERT_EQ(hit.has_value(), std::isfinite(truth.distance_m)) << i;
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR(hit->distance_m, truth.distance_m, 1e-5) << i;
        EXPECT_EQ(hit->node, truth.node) << i;
    }
    EXPECT_GT(hits, 500);
    EXPECT_LT(hits, 1990);
}

TEST(SetSurface, RaysMeetTheNearestTriangleOfAll) {
    const stage::GltfScene scene = some_set();
    const stage::PosedScene pose = stage::pose_scene(scene, stage::kNoAnimation, 0);
    SetSurface set;
    set.follow(scene, pose);
    expect_rays_meet(set, scene, pose);
}

TEST(SetSurface, ItFollowsWhatMoves) {
    stage::GltfScene scene = some_set();
    stage::PosedScene pose = stage::pose_scene(scene, stage::kNoAnimation, 0);
    SetSurface set;
    set.follow(scene, pose);
    pose.world_from_node[0] = glm::translate(glm::dmat4(1), glm::dvec3(0.3, 1.2, -1));
    pose.morph_weights[4] = {1.5f};
    pose.world_from_node[1] = glm::scale(pose.world_from_node[1], glm::dvec3(1, 1, 0));
    set.follow(scene, pose);
    expect_rays_meet(set, scene, pose);
    pose.world_from_node[1] = glm::dmat4(1);
    pose.world_from_node[4] = glm::translate(glm::dmat4(1), glm::dvec3(-0.5, 1, -1));
    set.follow(scene, pose);
    expect_rays_meet(set, scene, pose);
    scene.nodes[1].visible = false;
    set.follow(scene, pose);
    expect_rays_meet(set, scene, pose);
}

TEST(SetSurface, ARayAlongAnAxisMeetsAFlatWall) {
    GlbBuilder glb;
    add_mesh(glb, rectangle({-1, -1, -3}, {2, 0, 0}, {0, 2, 0}));
    glb.root["scenes"] = {{{"nodes", {0}}}};
    glb.root["scene"] = 0;
    const stage::GltfScene scene = scene_of(glb);
    SetSurface set;
    set.follow(scene, stage::pose_scene(scene, stage::kNoAnimation, 0));
    const auto hit = set.meet({{0.25, 0.5, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->distance_m, 4);
    EXPECT_TRUE(set.meet({{1, 0.5, 1}, {0, 0, -1}})) << "its edge belongs to it";
    EXPECT_FALSE(set.meet({{0, 0, 1}, {0, 0, 1}})) << "it is behind";
    EXPECT_FALSE(set.meet({{0, 0, -3}, {1, 0, 0}})) << "the ray lies in the wall";
    EXPECT_FALSE(SetSurface().meet({{0, 0, 0}, {0, 0, -1}}));
}

}  // namespace
}  // namespace neuvv::test
