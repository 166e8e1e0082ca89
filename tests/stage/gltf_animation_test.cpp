// Animations, nodes and skins of glTF files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "stage/glb_builder.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/gltf_triangle.h"
#include "stage/pose.h"
#include "support/near.h"

namespace neuvv::test::gltf_test {
namespace {

TEST(GltfScene, LinearAnimationOfTranslationRotationScale) {
    GlbBuilder glb = triangle();
    const int times = glb.scalar({0, 1, 3});
    animate(glb, "translation", "LINEAR", times, glb.vec3({0, 0, 0, 2, 0, 0, 2, 4, 0}));
    const float h = std::sqrt(0.5f);
    animate(glb, "rotation", "LINEAR", times, glb.vec4({0, 0, 0, 1, 0, 0, h, h, 0, 0, -h, -h}));
    animate(glb, "scale", "LINEAR", times, glb.vec3({1, 1, 1, 3, 1, 1, 3, 1, 1}));
    const stage::GltfScene scene = scene_of(glb);
    EXPECT_NEAR(scene.animations[0].duration_s, 3, 1e-9);
    expect_near(origin_at(scene, -1), {0, 0, 0}, 1e-5);
    expect_near(origin_at(scene, 0.25), {0.5, 0, 0}, 1e-5);
    expect_near(origin_at(scene, 2), {2, 2, 0}, 1e-5);
    expect_near(origin_at(scene, 9), {2, 4, 0}, 1e-5);
    // Half of the quarter turn; x scaled by 2. Later the quaternion only changes its sign, which is no motion.
    const double d = std::sqrt(0.5) * 2;
    expect_near(glm::dvec3(stage::pose_scene(scene, 0, 0.5).world_from_node[0][0]), {d, d, 0}, 1e-5);
    expect_near(glm::dvec3(stage::pose_scene(scene, 0, 2).world_from_node[0][0]), {0, 3, 0}, 1e-5);
    expect_near(glm::dvec3(stage::pose_scene(scene, stage::kNoAnimation, 2).world_from_node[0][0]), {1, 0, 0}, 1e-5);
}

TEST(GltfScene, StepAnimationHoldsTheKeyBefore) {
    GlbBuilder glb = triangle();
    animate(glb, "translation", "STEP", glb.scalar({0, 1, 2}), glb.vec3({0, 0, 0, 5, 0, 0, 7, 0, 0}));
    const stage::GltfScene scene = scene_of(glb);
    expect_near(origin_at(scene, 0.999), {0, 0, 0}, 1e-5);
    expect_near(origin_at(scene, 1), {5, 0, 0}, 1e-5);
    expect_near(origin_at(scene, 2.5), {7, 0, 0}, 1e-5);
}

TEST(GltfScene, CubicSplineFollowsHermite) {
    GlbBuilder glb = triangle();
    // Keys at 0 and 2 s: in-tangent, value, out-tangent.
    animate(glb, "translation", "CUBICSPLINE", glb.scalar({0, 2}),
            glb.vec3({9, 9, 9, 1, 0, 0, 3, 0, 0, -1, 0, 0, 2, 0, 0, 9, 9, 9}));
    const stage::GltfScene scene = scene_of(glb);
    expect_near(origin_at(scene, 0), {1, 0, 0}, 1e-5);
    expect_near(origin_at(scene, 2), {2, 0, 0}, 1e-5);
    // s = 1/2: (p0 + p1)/2 + dt (m0 - m1)/8.
    expect_near(origin_at(scene, 1), {1.5 + 2 * (3 + 1) / 8.0, 0, 0}, 1e-5);
    const double s = 0.25, s2 = s * s, s3 = s2 * s;
    expect_near(
        origin_at(scene, 0.5),
        {(2 * s3 - 3 * s2 + 1) * 1 + 2 * (s3 - 2 * s2 + s) * 3 + (3 * s2 - 2 * s3) * 2 + 2 * (s3 - s2) * -1, 0, 0},
        1e-5);
}

TEST(GltfScene, ChildrenFollowTheirParents) {
    GlbBuilder glb = triangle();
    glb.root["nodes"] = {{{"mesh", 0}, {"translation", {0, 0, 1}}},
                         {{"children", {0}}, {"scale", {2, 2, 2}}},
                         {{"children", {1}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}},
                         {{"mesh", 0}}};
    glb.root["scenes"] = {{{"nodes", {2}}}};
    const stage::GltfScene scene = scene_of(glb);
    expect_near(stage::pose_scene(scene, stage::kNoAnimation, 0).world_from_node[0][3], {5, 0, 2}, 1e-5);
    EXPECT_TRUE(scene.nodes[0].in_scene);
    EXPECT_FALSE(scene.nodes[3].in_scene);
    const auto [low, high] = stage::bounds_over(scene, stage::kNoAnimation, {0});
    expect_near(low, {5, 0, 2}, 1e-5);
    expect_near(high, {7, 2, 2}, 1e-5);
}

TEST(GltfScene, SkinningMatchesHandCalculation) {
    const stage::GltfScene scene = scene_of(arm());
    stage::PosedVertices out;
    stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, scene.meshes[0].primitives[0],
                         out);
    expect_near(out.positions[0], {1, 0, 0}, 1e-5);  // joint 0 alone; the node's own translation is ignored
    // (0,1.5) is the mean of both: joint 0 does not move it, joint 1 turns it about (0,1) to (-0.5,1).
    expect_near(out.positions[1], {-0.25, 1.25, 0}, 1e-5);
    expect_near(out.positions[2], {-1, 1, 0}, 1e-5);  // a single weight of 0.5 is normalised to 1
    expect_near(out.normals[0], {1, 0, 0}, 1e-5);
    expect_near(out.normals[1], glm::normalize(glm::dvec3(1, 1, 0)), 1e-5);
    expect_near(out.normals[2], {-1, 0, 0}, 1e-5);
}

// The four corners of a square, moved by eight and twelve joints: each vertex by joint v of each of the sets.
TEST(GltfScene, SkinsHaveMoreThanFourJoints) {
    for (const size_t sets : {2u, 3u}) {
        GlbBuilder glb = triangle();
        const size_t count = 4 * sets;
        std::vector<float> binds(16 * count, 0.0f);
        json joints = json::array();
        for (size_t j = 0; j < count; ++j) {
            for (const size_t at : {0u, 5u, 10u, 15u}) binds[16 * j + at] = 1;
            joints.push_back(j + 1);
            glb.root["nodes"].push_back({{"translation", {0, 0, std::pow(2.0, static_cast<double>(j))}}});
        }
        for (size_t set = 0; set < sets; ++set) {
            std::vector<uint8_t> indices;
            std::vector<float> weights;
            for (size_t v = 0; v < 3; ++v)
                for (size_t k = 0; k < 4; ++k) {
                    indices.push_back(static_cast<uint8_t>(4 * set + k));
                    weights.push_back(k == v ? 2.0f : 0.0f);  // the sum of all sets is not 1
                }
            primitive(glb)["attributes"][fmt::format("JOINTS_{}", set)] = glb.add(indices, test::kU8, "VEC4", 4);
            primitive(glb)["attributes"][fmt::format("WEIGHTS_{}", set)] = glb.vec4(weights);
        }
        glb.root["skins"] = {{{"joints", joints}, {"inverseBindMatrices", glb.floats(binds, "MAT4", 16)}}};
        glb.root["nodes"][0]["skin"] = 0;
        const stage::GltfScene scene = scene_of(glb);
        stage::PosedVertices out;
        stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, scene.meshes[0].primitives[0],
                             out);
        for (size_t v = 0; v < 3; ++v) {
            double z = 0;
            for (size_t set = 0; set < sets; ++set)
                z += std::pow(2.0, static_cast<double>(4 * set + v)) / static_cast<double>(sets);
            EXPECT_NEAR(out.positions[v].z, z, 1e-3);
        }
        primitive(glb)["attributes"].erase("WEIGHTS_1");
        expect_error(glb, "/attributes", "only one of JOINTS_1 and WEIGHTS_1");
    }
}

TEST(GltfScene, SkinsWithoutMatricesBindWhereTheyAre) {
    GlbBuilder glb = arm();
    glb.root["skins"][0].erase("inverseBindMatrices");
    const stage::GltfScene scene = scene_of(glb);
    EXPECT_EQ(scene.skins.at(0).inverse_binds.at(1), glm::dmat4(1));
    EXPECT_TRUE(scene.notes.empty());
    stage::PosedVertices out;
    stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, scene.meshes[0].primitives[0],
                         out);
    expect_near(out.positions[2], {-2, 1, 0}, 1e-5);
}

// Channels without a node are ignored, in a .glb with its buffer and in a .gltf.
TEST(GltfScene, ChannelsWithoutANodeAreLeftOut) {
    GlbBuilder glb = triangle();
    const int times = glb.scalar({0, 1});
    animate(glb, "translation", "LINEAR", times, glb.vec3({0, 0, 0, 2, 0, 0}));
    animate(glb, "translation", "LINEAR", times, glb.vec3({0, 0, 0, 9, 0, 0}));
    json& channels = glb.root["animations"][0]["channels"];
    channels[0]["target"].erase("node");
    stage::GltfScene scene = scene_of(glb);
    ASSERT_EQ(scene.animations.at(0).channels.size(), 1u);
    expect_near(origin_at(scene, 1), {9, 0, 0}, 1e-5);
    EXPECT_EQ(scene.notes,
              std::vector<std::string>{"leaves out 1 of the channels of animation 0 \"Move\", which move no node"});
    channels[0]["target"]["path"] = "pointer";
    channels[0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/materials/0/alphaCutoff";
    channels.erase(1);
    scene = scene_of(glb);
    EXPECT_TRUE(scene.animations.at(0).channels.empty());
    EXPECT_EQ(scene.animations[0].duration_s, 0);
    EXPECT_NE(scene.notes.at(0).find("1 by KHR_animation_pointer"), std::string::npos);
    const TemporaryFolder folder;
    glb.root["buffers"] = {{{"byteLength", glb.binary.size()}, {"uri", "data.bin"}}};
    folder.write(glb.binary, "data.bin");
    const std::string text = glb.root.dump();
    EXPECT_TRUE(stage::load_gltf(folder.write({text.begin(), text.end()}, "x.gltf")).animations.at(0).channels.empty());
}

TEST(GltfScene, NormalisedIntegersAnimate) {
    GlbBuilder glb = triangle();
    const std::vector<int16_t> turns = {0, 0, 0, 32767, 0, 0, 23170, 23170};
    const int output = glb.add(turns, 5122, "VEC4", 4);
    glb.root["accessors"][static_cast<size_t>(output)]["normalized"] = true;
    const int times = glb.scalar({0, 1});
    animate(glb, "rotation", "LINEAR", times, output);
    primitive(glb)["targets"] = {{{"POSITION", glb.vec3({0, 0, 4, 0, 0, 0, 0, 0, 0})}}};
    const int weights = glb.add(std::vector<uint8_t>{0, 51, 0, 0}, test::kU8, "SCALAR", 1);
    glb.root["accessors"][static_cast<size_t>(weights)]["count"] = 2;
    glb.root["accessors"][static_cast<size_t>(weights)]["normalized"] = true;
    animate(glb, "weights", "LINEAR", times, weights);
    const stage::PosedScene pose = stage::pose_scene(scene_of(glb), 0, 1);
    expect_near(glm::dvec3(pose.world_from_node[0][0]), {0, 1, 0}, 1e-4);
    EXPECT_NEAR(pose.morph_weights[0][0], 0.2, 1e-6);
}

TEST(GltfScene, AnimationsAreFoundByNameOrIndex) {
    GlbBuilder glb = triangle();
    animate(glb, "translation", "LINEAR", glb.scalar({0}), glb.vec3({0, 0, 0}));
    const stage::GltfScene scene = scene_of(glb);
    EXPECT_EQ(stage::find_animation(scene, "Move"), 0u);
    EXPECT_EQ(stage::find_animation(scene, "0"), 0u);
    for (const char* wrong : {"Walk", "1", "", "0x"}) {
        try {
            stage::find_animation(scene, wrong);
            FAIL() << wrong;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("0 \"Move\""), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace neuvv::test::gltf_test
