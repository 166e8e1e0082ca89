// What tests of glTF files begin with: a triangle, which they then change, and what reading it says.
#pragma once

#include <gtest/gtest.h>

#include "base/error.h"
#include "stage/glb_builder.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/pose.h"

namespace neuvv::test::gltf_test {

// The error's text, or "" where loading succeeds.
inline std::string error_of(const std::vector<uint8_t>& bytes, const std::string& name = "model.glb") {
    const TemporaryFolder folder;
    try {
        stage::load_gltf(folder.write(bytes, name));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

inline std::string error_of(const GlbBuilder& glb) {
    return error_of(glb.bytes());
}

inline void expect_error(const GlbBuilder& glb, const std::string& place, const std::string& problem) {
    const std::string error = error_of(glb);
    EXPECT_NE(error.find(place), std::string::npos) << error;
    EXPECT_NE(error.find(problem), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

inline const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

// One triangle on one node.
inline GlbBuilder triangle() {
    GlbBuilder glb;
    const int positions = glb.vec3(kTriangle);
    glb.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}}};
    glb.root["nodes"] = {{{"mesh", 0}, {"name", "a"}}};
    glb.root["scenes"] = {{{"nodes", {0}}}};
    return glb;
}

inline json& primitive(GlbBuilder& glb) {
    return glb.root["meshes"][0]["primitives"][0];
}

inline void animate(GlbBuilder& glb, const std::string& path, const std::string& interpolation, int input, int output) {
    json& animation = glb.root["animations"][0];
    animation["name"] = "Move";
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", 0}, {"path", path}}}});
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
}

inline glm::dvec3 origin_at(const stage::GltfScene& scene, double t) {
    return stage::pose_scene(scene, 0, t).world_from_node[0][3];
}

// Two joints: the first is at the origin, the second 1 m above it and turned by 90° about z.
inline GlbBuilder arm() {
    GlbBuilder glb = triangle();
    const std::vector<uint8_t> joints = {0, 9, 9, 9, 0, 1, 0, 0, 1, 0, 0, 0};
    primitive(glb)["attributes"]["POSITION"] = glb.vec3({1, 0, 0, 0, 1.5, 0, 0, 2, 0});
    primitive(glb)["attributes"]["NORMAL"] = glb.vec3({1, 0, 0, 1, 0, 0, 0, 1, 0});
    primitive(glb)["attributes"]["JOINTS_0"] = glb.add(joints, test::kU8, "VEC4", 4);
    primitive(glb)["attributes"]["WEIGHTS_0"] = glb.vec4({1, 0, 0, 0, 1, 1, 0, 0, 0.5f, 0, 0, 0});
    std::vector<float> binds(32, 0.0f);
    for (size_t i = 0; i < 32; i += 16) binds[i] = binds[i + 5] = binds[i + 10] = binds[i + 15] = 1;
    binds[16 + 13] = -1;
    glb.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", glb.floats(binds, "MAT4", 16)}}};
    const float h = std::sqrt(0.5f);
    glb.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                         {{"children", {2}}},
                         {{"translation", {0, 1, 0}}, {"rotation", {0, 0, h, h}}}};
    glb.root["scenes"] = {{{"nodes", {0, 1}}}};
    return glb;
}

}  // namespace neuvv::test::gltf_test
