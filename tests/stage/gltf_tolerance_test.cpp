// glTF files that are read although a reader could refuse them, and what is left out of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "base/text.h"
#include "stage/glb_builder.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/gltf_triangle.h"
#include "support/near.h"

namespace neuvv::test::gltf_test {
namespace {

// A morph target and a mesh whose accessors are zeros but for some elements.
TEST(GltfScene, SparseAccessorsNeedNoBufferOfTheirOwn) {
    GlbBuilder glb = triangle();
    const std::vector<uint8_t> indices = {2};
    const std::vector<float> values = {0, 0, 5};
    glb.root["accessors"].push_back(
        {{"componentType", test::kF32},
         {"count", 3},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 1},
           {"indices", {{"bufferView", glb.add_view(indices.data(), 1)}, {"componentType", test::kU8}}},
           {"values", {{"bufferView", glb.add_view(values.data(), 12)}}}}}});
    primitive(glb)["targets"] = {{{"POSITION", 1}}};
    const stage::GltfScene scene = scene_of(glb);
    const std::vector<glm::vec3>& moved = scene.meshes[0].primitives[0].targets.at(0).positions;
    expect_near(moved[0], {0, 0, 0}, 1e-9);
    expect_near(moved[2], {0, 0, 5}, 1e-9);
}

// What tinygltf refuses, though glTF allows it: chunks of odd sizes, an empty buffer, media types of data URIs, and a
// spotlight of default angles.
TEST(GltfScene, ReadsWhatTinygltfRefuses) {
    GlbBuilder glb = triangle();
    std::vector<uint8_t> bytes = glb.bytes();
    const auto word = [&](size_t at, uint32_t value) { std::memcpy(&bytes[at], &value, sizeof(value)); };
    bytes.resize(bytes.size() + 1);
    word(8, static_cast<uint32_t>(bytes.size()));
    word(bytes.size() - 1 - glb.binary.size() - 8, static_cast<uint32_t>(glb.binary.size()) + 1);
    EXPECT_EQ(error_of(bytes), "") << "a buffer of 37 bytes";

    glb.root["buffers"] = {{{"byteLength", glb.binary.size()}, {"uri", ""}}};
    for (const char* type :
         {"application/octet-stream", "application/gltf-buffer", "model/gltf-buffer", "application/x-binary", ""}) {
        glb.root["buffers"][0]["uri"] = fmt::format("data:{};base64,{}", type, base64(glb.binary));
        const std::string json_text = glb.root.dump();
        EXPECT_EQ(error_of({json_text.begin(), json_text.end()}, "x.gltf"), "") << type;
    }
    const TemporaryFolder folder;
    glb.root["buffers"][0]["uri"] = "long.bin";
    std::vector<uint8_t> longer = glb.binary;
    longer.resize(longer.size() + 5);
    folder.write(longer, "long.bin");
    std::string text = glb.root.dump();
    EXPECT_NO_THROW(stage::load_gltf(folder.write({text.begin(), text.end()}, "x.gltf"))) << "a file that is longer";
    glb.root["buffers"][0]["uri"] = "data:;base64," + base64(longer);
    text = glb.root.dump();
    EXPECT_EQ(error_of({text.begin(), text.end()}, "x.gltf"), "") << "a data URI that is longer";
    glb.root["buffers"][0]["uri"] = "data:;base64," + base64(std::span(longer).first(20));
    text = glb.root.dump();
    EXPECT_NE(error_of({text.begin(), text.end()}, "x.gltf").find("/buffers/0/uri: has 20 bytes of 36"),
              std::string::npos);
    glb.root["buffers"][0]["uri"] = "data:text/plain,abc";
    text = glb.root.dump();
    EXPECT_NE(error_of({text.begin(), text.end()}, "x.gltf").find("/buffers/0/uri: is no data URI"), std::string::npos);

    glb.root["buffers"][0]["uri"] = "data:;base64," + base64(glb.binary);
    text = glb.root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.assign(20, 0);
    std::memcpy(bytes.data(), "glTF", 4);
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.resize(bytes.size() + 8);
    word(4, 2);
    word(8, static_cast<uint32_t>(bytes.size()));
    word(12, static_cast<uint32_t>(text.size()));
    word(16, 0x4E4F534A);
    word(bytes.size() - 4, 0x004E4942);
    EXPECT_EQ(error_of(bytes), "") << "an empty buffer";

    glb = triangle();
    glb.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}}};
    glb.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    EXPECT_NEAR(scene_of(glb).lights.at(0).outer_cone_rad, glm::radians(45.0), 1e-3);
}

TEST(GltfScene, ExtrasMayBeAnything) {
    GlbBuilder glb = triangle();
    for (const json& extras : {json({1, 2}), json({"a", {{"b", 1}}}), json("text"), json(3)}) {
        glb.root["extras"] = extras;
        EXPECT_EQ(error_of(glb), "") << extras;
    }
    glb.root["extensionsUsed"] = {1};
    expect_error(glb, "/extensionsUsed/0", "is not a string");
}

// JSON does not tell 24 and 24.0 apart, and some exporters write all numbers so.
TEST(GltfScene, WholeNumbersMayHaveAPoint) {
    const stage::GltfScene truth = scene_of(arm());
    GlbBuilder glb = arm();
    primitive(glb)["targets"] = {{{"POSITION", 0}}};
    const std::function<void(json&)> add_points = [&](json& value) {
        if (value.is_number_integer()) value = value.get<double>();
        if (value.is_structured())
            for (json& element : value) add_points(element);
    };
    add_points(glb.root);
    ASSERT_NE(glb.root.dump().find("\"count\":3.0"), std::string::npos);
    const stage::GltfScene scene = scene_of(glb);
    EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions, truth.meshes[0].primitives[0].positions);
    EXPECT_EQ(scene.skins.at(0).joints, truth.skins[0].joints);
    EXPECT_EQ(scene.nodes.at(1).children, truth.nodes[1].children);
    glb.root["nodes"][1]["children"][0] = 2.5;
    EXPECT_NE(error_of(glb), "");
    glb.root["nodes"][1]["children"][0] = -2.0;
    EXPECT_NE(error_of(glb), "");
}

TEST(GltfScene, SparseIndicesNeedNoBufferOfTheirOwn) {
    GlbBuilder glb = triangle();
    const std::vector<uint8_t> places = {1, 2};
    const std::vector<uint16_t> values = {1, 2};
    glb.root["accessors"].push_back(
        {{"componentType", test::kU16},
         {"count", 3},
         {"type", "SCALAR"},
         {"sparse",
          {{"count", 2},
           {"indices", {{"bufferView", glb.add_view(places.data(), 2)}, {"componentType", test::kU8}}},
           {"values", {{"bufferView", glb.add_view(values.data(), 4)}}}}}});
    primitive(glb)["indices"] = 1;
    EXPECT_EQ(scene_of(glb).meshes.at(0).primitives.at(0).indices, (std::vector<uint32_t>{0, 1, 2}));
    primitive(glb)["extensions"]["KHR_draco_mesh_compression"] = json::object();
    expect_error(glb, "/meshes/0/primitives/0", "compressed by KHR_draco_mesh_compression");
    primitive(glb)["indices"] = 9;
    expect_error(glb, "/meshes/0/primitives/0/indices", "accessor 9 does not exist");
}

TEST(GltfScene, LeavesOutWhatHasNoImageOrNoPositions) {
    GlbBuilder glb = triangle();
    glb.root["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    glb.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    primitive(glb)["material"] = 0;
    glb.root["meshes"][0]["primitives"].push_back({{"attributes", json::object()}});
    const stage::GltfScene scene = scene_of(glb);
    EXPECT_EQ(scene.materials.at(0).texture, -1);
    EXPECT_EQ(scene.meshes.at(0).primitives.size(), 1u);
    const std::vector<std::string> notes = {"leaves out 1 of 1 textures, which have no PNG or JPEG",
                                            "leaves out 1 primitives without positions"};
    EXPECT_EQ(scene.notes, notes);
}

TEST(GltfScene, SaysWhatItDoesNotShow) {
    GlbBuilder glb = triangle();
    glb.root["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_texture_transform", "EXT_texture_webp"};
    json lines = primitive(glb);
    lines["mode"] = 1;
    glb.root["meshes"][0]["primitives"].push_back(lines);
    glb.root["meshes"][0]["name"] = "Fence";
    primitive(glb)["targets"] = {{{"POSITION", 0}, {"COLOR_0", 0}}};
    glb.root["scenes"].push_back({{"nodes", {0}}});
    const std::vector<std::string> notes = {
        "does not read KHR_materials_clearcoat, EXT_texture_webp", "draws no points, lines or splats: Fence",
        "morphs positions and normals; 1 primitives have targets of colours or texture coordinates",
        "shows its scene 0 alone; it has 2"};
    EXPECT_EQ(scene_of(glb).notes, notes);
}

// A stage may hold them, as exported splats are points; triangles of the same mesh are drawn.
TEST(GltfScene, PointsAndLinesAreLeftOut) {
    for (const int mode : {0, 1, 2, 3}) {
        GlbBuilder glb = triangle();
        primitive(glb)["mode"] = mode;
        EXPECT_TRUE(scene_of(glb).meshes.at(0).primitives.empty());
        json triangles = primitive(glb);
        triangles["mode"] = 4;
        glb.root["meshes"][0]["primitives"].push_back(triangles);
        ASSERT_EQ(scene_of(glb).meshes.at(0).primitives.size(), 1u);
        EXPECT_EQ(scene_of(glb).meshes[0].primitives[0].indices.size(), 3u);
    }
}

}  // namespace
}  // namespace neuvv::test::gltf_test
