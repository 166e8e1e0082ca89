// Meshes and materials of glTF files.
#include <gtest/gtest.h>

#include "base/error.h"
#include "stage/glb_builder.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/gltf_triangle.h"
#include "stage/pose.h"
#include "support/near.h"

namespace neuvv::test::gltf_test {
namespace {

TEST(GltfScene, FlatNormalsWhereTheFileHasNone) {
    const stage::GltfScene scene = scene_of(triangle());
    const stage::GltfPrimitive& mesh = scene.meshes.at(0).primitives.at(0);
    ASSERT_EQ(mesh.normals.size(), 3u);
    expect_near(mesh.normals[1], {0, 0, 1}, 1e-5);
    EXPECT_EQ(mesh.indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_TRUE(scene.nodes[0].in_scene);
}

TEST(GltfScene, StripsAndFansKeepTheirWinding) {
    for (const int mode : {5, 6}) {
        GlbBuilder glb = triangle();
        const std::vector<float> strip = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        const std::vector<float> fan = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
        primitive(glb)["attributes"]["POSITION"] = glb.vec3(mode == 5 ? strip : fan);
        primitive(glb)["mode"] = mode;
        const stage::GltfPrimitive mesh = scene_of(glb).meshes[0].primitives[0];
        ASSERT_EQ(mesh.indices.size(), 6u);
        for (const glm::vec3& normal : mesh.normals) expect_near(normal, {0, 0, 1}, 1e-5);
    }
}

TEST(GltfScene, MorphTargetsAddUp) {
    GlbBuilder glb = triangle();
    primitive(glb)["attributes"]["NORMAL"] = glb.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
    primitive(glb)["targets"] = {
        {{"POSITION", glb.vec3({0, 0, 4, 0, 0, 0, 0, 0, 0})}},
        {{"POSITION", glb.vec3({0, 2, 0, 0, 0, 0, 0, 0, 0})}, {"NORMAL", glb.vec3({2, 0, 0, 0, 0, 0, 0, 0, 0})}}};
    glb.root["meshes"][0]["weights"] = {0.25, 0};
    animate(glb, "weights", "LINEAR", glb.scalar({0, 1}), glb.scalar({0.25f, 0, 0.75f, 1}));
    const stage::GltfScene scene = scene_of(glb);
    stage::PosedVertices out;
    stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, scene.meshes[0].primitives[0],
                         out);
    expect_near(out.positions[0], {0, 0, 1}, 1e-5);
    stage::pose_vertices(scene, stage::pose_scene(scene, 0, 0.5), 0, scene.meshes[0].primitives[0], out);
    expect_near(out.positions[0], {0, 1, 2}, 1e-5);
    expect_near(out.normals[0], glm::normalize(glm::dvec3(1, 0, 1)), 1e-5);
    expect_near(out.positions[1], {1, 0, 0}, 1e-5);
}

TEST(GltfScene, MirroringNodesSayThatTheirTrianglesTurn) {
    GlbBuilder glb = triangle();
    glb.root["nodes"][0]["scale"] = {-1, 1, 1};
    const stage::GltfScene scene = scene_of(glb);
    stage::PosedVertices out;
    stage::pose_vertices(scene, stage::pose_scene(scene, stage::kNoAnimation, 0), 0, scene.meshes[0].primitives[0],
                         out);
    EXPECT_TRUE(out.mirrored);
    expect_near(out.normals[0], {0, 0, 1}, 1e-5);
}

TEST(GltfScene, VertexColoursOfEveryKind) {
    GlbBuilder glb = triangle();
    const std::vector<uint8_t> bytes = {255, 0, 51, 255, 0, 0, 0, 0, 0, 0, 0, 0};
    const int normalised = glb.add(bytes, test::kU8, "VEC4", 4);
    glb.root["accessors"][static_cast<size_t>(normalised)]["normalized"] = true;
    primitive(glb)["attributes"]["COLOR_0"] = normalised;
    glm::vec4 color = scene_of(glb).meshes[0].primitives[0].colors.at(0);
    EXPECT_NEAR(color.b, 0.2, 1e-6);
    EXPECT_NEAR(color.r, 1, 1e-6);
    primitive(glb)["attributes"]["COLOR_0"] = glb.vec3({0.5f, 0.25f, 0, 0, 0, 0, 0, 0, 0});
    color = scene_of(glb).meshes[0].primitives[0].colors.at(0);
    EXPECT_NEAR(color.g, 0.25, 1e-6);
    EXPECT_NEAR(color.a, 1, 1e-6);
    glb.root["accessors"][static_cast<size_t>(normalised)].erase("normalized");
    primitive(glb)["attributes"]["COLOR_0"] = normalised;
    expect_error(glb, "COLOR_0", "normalised");
}

TEST(GltfScene, MaterialsAndTextureTransform) {
    GlbBuilder glb = triangle();
    // An invalid image is only an error where a base colour uses it; then media reports it.
    glb.root["images"] = {{{"bufferView", glb.add_view("nonsense", 8)}, {"mimeType", "image/png"}}};
    glb.root["materials"] = {
        {{"extensions", {{"KHR_materials_unlit", json::object()}}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true},
         {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 1}}, {"roughnessFactor", 0.5}}}}};
    primitive(glb)["material"] = 0;
    const stage::GltfMaterial material = scene_of(glb).materials.at(0);
    EXPECT_TRUE(material.unlit && material.double_sided);
    EXPECT_EQ(material.alpha, stage::GltfAlpha::kMask);
    EXPECT_NEAR(material.alpha_cutoff, 0.25, 1e-6);
    EXPECT_NEAR(material.base_color.g, 0.5, 1e-6);
    EXPECT_NEAR(material.roughness, 0.5, 1e-6);
    EXPECT_EQ(material.texture, -1);

    glb.root["textures"] = {{{"source", 0}}};
    glb.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    EXPECT_NE(error_of(glb), "") << "the broken image is used now";
}

TEST(GltfScene, SparseAccessorsReplaceElements) {
    GlbBuilder glb = triangle();
    const std::vector<uint16_t> indices = {1};
    const std::vector<float> values = {7, 8, 0};
    json& accessor = glb.root["accessors"][0];
    accessor["sparse"] = {{"count", 1},
                          {"indices", {{"bufferView", glb.add_view(indices.data(), 2)}, {"componentType", test::kU16}}},
                          {"values", {{"bufferView", glb.add_view(values.data(), 12)}}}};
    expect_near(scene_of(glb).meshes[0].primitives[0].positions[1], {7, 8, 0}, 1e-5);
    accessor["sparse"]["indices"]["componentType"] = test::kU32;
    expect_error(glb, "/accessors/0/sparse/indices", "bufferView");
}

}  // namespace
}  // namespace neuvv::test::gltf_test
