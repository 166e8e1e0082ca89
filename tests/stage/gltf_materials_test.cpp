// Tests that metallic-roughness materials, UV sets and tangents are read, and that invalid ones are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "media/image.h"
#include "stage/glb_builder.h"
#include "stage/pose.h"

namespace neuvv::test {
namespace {

// A rectangle in the XY plane that faces +Z, U along +X and V along −Y, with a material of all textures: image 0 for
// the base colour, 1 for everything else.
GlbBuilder rectangle() {
    GlbBuilder glb;
    glb.root["meshes"] = {{{"primitives",
                            {{{"attributes",
                               {{"POSITION", glb.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})},
                                {"NORMAL", glb.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
                                {"TEXCOORD_0", glb.floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2)},
                                {"TEXCOORD_1", glb.floats({0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25}, "VEC2", 2)}}},
                              {"indices", glb.add(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}, test::kU16, "SCALAR", 1)},
                              {"material", 0}}}}}};
    glb.root["nodes"] = {{{"mesh", 0}}};
    for (int i = 0; i < 2; ++i) {
        media::Image image(2, 2);
        image.rgba.assign(16, static_cast<uint8_t>(100 + i));
        const std::vector<uint8_t> png = media::encode_png(image);
        glb.root["images"].push_back({{"bufferView", glb.add_view(png.data(), png.size())}, {"mimeType", "image/png"}});
        glb.root["textures"].push_back({{"source", i}});
    }
    glb.root["materials"] = {{{"pbrMetallicRoughness",
                               {{"baseColorTexture", {{"index", 0}}},
                                {"metallicRoughnessTexture", {{"index", 1}}},
                                {"metallicFactor", 0.25},
                                {"roughnessFactor", 0.75}}},
                              {"normalTexture", {{"index", 1}, {"scale", 0.5}}},
                              {"occlusionTexture", {{"index", 1}, {"strength", 0.25}, {"texCoord", 1}}},
                              {"emissiveTexture", {{"index", 1}}},
                              {"emissiveFactor", {0.5, 1, 0.25}},
                              {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
    return glb;
}

const stage::GltfPrimitive& primitive_of(const stage::GltfScene& scene) {
    return scene.meshes.at(0).primitives.at(0);
}

std::vector<glm::vec4> tangents_of(const GlbBuilder& glb) {
    return primitive_of(scene_of(glb)).tangents;
}

void expect_vec4(const glm::vec4& a, const glm::vec4& b) {
    EXPECT_LT(glm::length(a - b), 1e-6f) << a.x << ' ' << a.y << ' ' << a.z << ' ' << a.w << " instead of " << b.x
                                         << ' ' << b.y << ' ' << b.z << ' ' << b.w;
}

TEST(GltfMaterials, EverythingOfAMaterialIsRead) {
    GlbBuilder glb = rectangle();
    glb.root["extensionsUsed"] = glb.root["extensionsRequired"] = {"KHR_materials_emissive_strength"};
    const stage::GltfScene scene = scene_of(glb);
    const stage::GltfMaterial& material = scene.materials.at(0);
    EXPECT_EQ(material.texture, 0);
    for (const int32_t map : material.maps) EXPECT_EQ(map, 1);
    EXPECT_EQ(material.metallic, 0.25f);
    EXPECT_EQ(material.roughness, 0.75f);
    EXPECT_EQ(material.normal_scale, 0.5f);
    EXPECT_EQ(material.occlusion_strength, 0.25f);
    EXPECT_EQ(material.emissive, glm::vec3(2, 4, 1));
    EXPECT_EQ(scene.images.at(1)->pixels.at(0, 0)[0], 101) << "decoded, though no base colour uses it";
    const stage::GltfPrimitive& primitive = primitive_of(scene);
    EXPECT_EQ(primitive.map_uvs[static_cast<size_t>(stage::GltfMap::kEmissive)], primitive.uvs);
    EXPECT_EQ(primitive.map_uvs[static_cast<size_t>(stage::GltfMap::kOcclusion)].at(2), glm::vec2(0.5f, 0.25f));
}

// KHR_mesh_quantization has texture coordinates as integers that are not normalised, which the transform scales.
TEST(GltfMaterials, IntegersAreTextureCoordinates) {
    GlbBuilder glb = rectangle();
    glb.root["extensionsUsed"] = glb.root["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_texture_transform"};
    glb.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
        {"scale", {0.5, 0.25}}, {"offset", {0.25, 0}}};
    json& uvs = glb.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"];
    uvs = glb.add(std::vector<uint16_t>{0, 0, 1, 0, 1000, 4, 0, 4}, test::kU16, "VEC2", 2);
    EXPECT_EQ(primitive_of(scene_of(glb)).uvs.at(2), glm::vec2(500.25f, 1));
    const std::vector<int8_t> narrow = {0, 0, 0, 0, 1, 0, 0, 0, 3, -4, 0, 0, 0, 4, 0, 0};
    uvs = glb.add(narrow, 5120, "VEC2", 4);
    glb.root["bufferViews"].back()["byteStride"] = 4;
    EXPECT_EQ(primitive_of(scene_of(glb)).uvs.at(2), glm::vec2(1.75f, -1));
}

TEST(GltfMaterials, ImagesThatStayAreNotDecodedAgain) {
    GlbBuilder glb = rectangle();
    const stage::GltfScene before = scene_of(glb);
    media::Image other(3, 2);
    other.rgba.assign(24, 7);
    const std::vector<uint8_t> png = media::encode_png(other);
    glb.root["images"][1]["bufferView"] = glb.add_view(png.data(), png.size());
    const TemporaryFolder folder;
    const stage::GltfScene after = stage::load_gltf(folder.path / "after.glb", glb.bytes(), &before);
    EXPECT_EQ(after.images.at(0), before.images.at(0));
    EXPECT_NE(after.images.at(1), before.images.at(1));
    EXPECT_EQ(after.images.at(1)->pixels.width, 3u);
}

TEST(GltfMaterials, MapsThatAreNotThereCostNothing) {
    GlbBuilder glb = rectangle();
    glb.root["materials"][0] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
    const stage::GltfScene scene = scene_of(glb);
    for (const auto& uvs : primitive_of(scene).map_uvs) EXPECT_TRUE(uvs.empty());
    EXPECT_TRUE(primitive_of(scene).tangents.empty());
    EXPECT_FALSE(scene.images.at(1)) << "no material uses it";
}

TEST(GltfMaterials, TangentsGoAlongU) {
    for (const glm::vec4& tangent : tangents_of(rectangle())) expect_vec4(tangent, {1, 0, 0, 1});
    GlbBuilder turned = rectangle();
    turned.root["materials"][0]["normalTexture"]["extensions"] = {
        {"KHR_texture_transform", {{"rotation", std::numbers::pi / 2}}}};
    for (const glm::vec4& tangent : tangents_of(turned)) expect_vec4(tangent, {0, -1, 0, 1});
    GlbBuilder mirrored = rectangle();
    mirrored.root["materials"][0]["normalTexture"]["extensions"] = {{"KHR_texture_transform", {{"scale", {1, -1}}}}};
    for (const glm::vec4& tangent : tangents_of(mirrored)) expect_vec4(tangent, {1, 0, 0, -1});
    GlbBuilder flat = rectangle();
    flat.root["materials"][0]["normalTexture"]["texCoord"] = 1;  // the same UV at all corners
    for (const glm::vec4& tangent : tangents_of(flat)) {
        EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1, 1e-6);
        EXPECT_NEAR(tangent.z, 0, 1e-6) << "any, across the normal";
    }
    GlbBuilder without = rectangle();
    without.root["materials"][0]["normalTexture"]["texCoord"] = 3;
    EXPECT_TRUE(tangents_of(without).empty()) << "there is no such UV set";
}

TEST(GltfMaterials, TheFilesTangentsAreMadeUnitAndOrthogonal) {
    GlbBuilder glb = rectangle();
    json& attributes = glb.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TANGENT"] = glb.vec4({0, 3, 5, -1, 0, 3, 0, -1, 0, 1, 0, -1, 0, 0, 0, 1});
    const stage::GltfScene scene = scene_of(glb);
    const std::vector<glm::vec4>& tangents = primitive_of(scene).tangents;
    for (size_t v = 0; v < 3; ++v) expect_vec4(tangents.at(v), {0, 1, 0, -1});
    EXPECT_NEAR(glm::length(glm::vec3(tangents.at(3))), 1, 1e-6) << "a tangent of length 0";
    attributes.erase("NORMAL");
    for (const glm::vec4& tangent : tangents_of(glb)) expect_vec4(tangent, {1, 0, 0, 1});
}

TEST(GltfMaterials, TangentsAreWeightedByAngles) {
    // Corner 0 has an angle of 90° in a triangle with U along +X and one of 45° in a triangle with U along +Y.
    GlbBuilder glb = rectangle();
    json& primitive = glb.root["meshes"][0]["primitives"][0];
    primitive["attributes"]["POSITION"] = glb.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 1, 0});
    primitive["attributes"]["TEXCOORD_0"] = glb.floats({0, 0, 1, 0, 0, -1, -1, -1}, "VEC2", 2);
    primitive["indices"] = glb.add(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}, test::kU16, "SCALAR", 1);
    expect_vec4(tangents_of(glb).at(0), {1, 0, 0, 1});
    // Now the second triangle's U goes along +Y: (0, 0) → corner 2 (0, 1) is one U.
    primitive["attributes"]["POSITION"] = glb.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -1, 1, 0});
    primitive["attributes"]["NORMAL"] = glb.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    primitive["attributes"]["TEXCOORD_0"] = glb.floats({0, 0, 1, 0, 0, -1, 0, 0, 1, 0, 1, -1}, "VEC2", 2);
    primitive["attributes"].erase("TEXCOORD_1");
    glb.root["materials"][0]["occlusionTexture"]["texCoord"] = 0;
    primitive["indices"] = glb.add(std::vector<uint16_t>{0, 1, 2, 3, 4, 5}, test::kU16, "SCALAR", 1);
    expect_vec4(tangents_of(glb).at(0), {1, 0, 0, 1});
    expect_vec4(tangents_of(glb).at(3), {0, 1, 0, 1});
    primitive["indices"] = glb.add(std::vector<uint16_t>{0, 1, 2, 0, 4, 5}, test::kU16, "SCALAR", 1);
    const glm::vec3 mixed = glm::normalize(glm::vec3(90, 45, 0));
    expect_vec4(tangents_of(glb).at(0), glm::vec4(mixed, 1));
}

TEST(GltfMaterials, TangentsArePosedWithTheirVertices) {
    const auto posed = [](const GlbBuilder& glb) {
        const stage::GltfScene scene = scene_of(glb);
        stage::PosedVertices vertices;
        stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, primitive_of(scene), vertices);
        return vertices.tangents.at(0);
    };
    GlbBuilder glb = rectangle();
    glb.root["nodes"][0]["scale"] = {2, 3, -1};
    expect_vec4(posed(glb), {1, 0, 0, -1});
    glb.root["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
    glb.root["nodes"][0]["scale"] = {2, 3, 1};
    expect_vec4(posed(glb), {0, 1, 0, 1});
}

TEST(GltfMaterials, BadMembersAreNamed) {
    const auto refuse = [](const std::function<void(json&, GlbBuilder&)>& change, const std::string& place) {
        GlbBuilder glb = rectangle();
        change(glb.root["materials"][0], glb);
        const TemporaryFolder folder;
        std::string error;
        try {
            stage::load_gltf(folder.write(glb.bytes()));
        } catch (const InputError& bad) {
            error = bad.what();
        }
        EXPECT_NE(error.find(place), std::string::npos) << place << ": " << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    };
    for (const char* slot : {"normalTexture", "occlusionTexture", "emissiveTexture"}) {
        const std::string place = std::string("/materials/0/") + slot;
        refuse([&](json& m, GlbBuilder&) { m[slot]["index"] = 9; }, place + "/index");
        refuse([&](json& m, GlbBuilder&) { m[slot]["index"] = "one"; }, place + "/index");
        refuse([&](json& m, GlbBuilder&) { m[slot]["texCoord"] = 900; }, place + "/texCoord");
        refuse([&](json& m, GlbBuilder&) { m[slot] = 1; }, place);
    }
    refuse([](json& m, GlbBuilder&) { m["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] = 2; },
           "/pbrMetallicRoughness/metallicRoughnessTexture/index");
    refuse([](json& m, GlbBuilder&) { m["pbrMetallicRoughness"] = json::array(); }, "/pbrMetallicRoughness");
    refuse([](json& m, GlbBuilder&) { m["pbrMetallicRoughness"]["roughnessFactor"] = "rough"; }, "/roughnessFactor");
    refuse([](json& m, GlbBuilder&) { m["normalTexture"]["scale"] = 1e9; }, "/normalTexture/scale");
    refuse([](json& m, GlbBuilder&) { m["normalTexture"]["scale"] = "big"; }, "/normalTexture/scale");
    refuse([](json& m, GlbBuilder&) { m["occlusionTexture"]["strength"] = 1.5; }, "/occlusionTexture/strength");
    refuse([](json& m, GlbBuilder&) { m["emissiveFactor"] = {0, -1, 0}; }, "/emissiveFactor");
    refuse([](json& m, GlbBuilder&) { m["emissiveFactor"] = {0, "x", 0}; }, "/emissiveFactor");
    for (const json& strength : {json(-1), json("x"), json(1e30)})
        refuse([&](json& m,
                   GlbBuilder&) { m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength; },
               "/emissiveStrength");
    refuse(
        [](json&, GlbBuilder& glb) {
            glb.root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = glb.vec4({1, 0, 0, 1});
        },
        "/attributes/TANGENT");
    refuse([](json&, GlbBuilder& glb) { glb.root["images"][1] = {{"uri", "missing.png"}}; }, "missing.png");
}

}  // namespace
}  // namespace neuvv::test
