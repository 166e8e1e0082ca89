// Damaged and malicious glTF files are refused with a message that names the place.
#include <gtest/gtest.h>

#include <ctime>
#include <random>

#include "base/error.h"
#include "stage/glb_builder.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/gltf_triangle.h"
#include "stage/pose.h"
#include "support/near.h"

namespace neuvv::test::gltf_test {
namespace {

TEST(GltfHostile, TruncatedAtEveryLength) {
    const std::vector<uint8_t> whole = arm().bytes();
    ASSERT_EQ(error_of(whole), "");
    for (size_t size = 0; size < whole.size(); size += 7)
        EXPECT_NE(error_of({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size)}), "") << size;
}

TEST(GltfHostile, AccessorsOutOfRange) {
    GlbBuilder glb = triangle();
    primitive(glb)["attributes"]["POSITION"] = 5;
    expect_error(glb, "/meshes/0/primitives/0/attributes/POSITION", "accessor 5");

    glb = triangle();
    glb.root["accessors"][0]["count"] = 4;
    expect_error(glb, "/accessors/0", "end at byte 48");
    glb.root["accessors"][0]["count"] = 4000000000000ull;
    expect_error(glb, "/accessors/0/count", "whole number");
    glb.root["accessors"][0]["count"] = 1000000000;
    expect_error(glb, "/accessors/0", "more than this program takes");
    glb.root["accessors"][0]["count"] = -1;
    expect_error(glb, "/accessors/0/count", "whole number");
    glb.root["accessors"][0]["count"] = 0;
    expect_error(glb, "/accessors/0", "no elements");

    glb = triangle();
    glb.root["accessors"][0]["byteOffset"] = 4;
    expect_error(glb, "/accessors/0", "end at byte 40");
    glb = triangle();
    glb.root["accessors"][0]["type"] = "VEC2";
    expect_error(glb, "/accessors/0", "components");
    glb = triangle();
    glb.root["accessors"][0]["componentType"] = 5124;
    EXPECT_NE(error_of(glb), "");
}

TEST(GltfHostile, ViewsAndBuffers) {
    GlbBuilder glb = triangle();
    glb.root["bufferViews"][0]["byteLength"] = 37;
    expect_error(glb, "/bufferViews/0", "ends at byte 37");
    glb.root["bufferViews"][0]["byteLength"] = 36;
    glb.root["bufferViews"][0]["buffer"] = 1;
    expect_error(glb, "/bufferViews/0", "buffer 1 does not exist");
    glb.root["bufferViews"][0]["buffer"] = "x";
    expect_error(glb, "/bufferViews/0/buffer", "index");
    glb = triangle();
    glb.root["bufferViews"][0]["byteStride"] = 4;
    expect_error(glb, "/accessors/0", "overlap");
    glb = triangle();
    glb.root["buffers"] = {{{"byteLength", 36}, {"uri", "nowhere.bin"}}};
    expect_error(glb, "nowhere.bin", "does not exist");
    glb.root["buffers"] = {"x"};
    expect_error(glb, "/buffers/0", "is not an object");
    glb.root["buffers"] = {{{"byteLength", 1000}}};
    EXPECT_NE(error_of(glb), "");
    glb.root["buffers"] = {{{"byteLength", 0}}};
    EXPECT_NE(error_of(glb), "");
}

TEST(GltfHostile, UrisMustStayInTheFolder) {
    for (const char* uri : {"/etc/passwd", "../x.bin", "a/../../x.bin", "%2e%2e/x.bin", "file:///etc/passwd",
                            "..\\x.bin", "%2e%2e%5cx.bin", "C:\\x.bin", ""}) {
        GlbBuilder glb = triangle();
        glb.root["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
        expect_error(glb, "/buffers/0/uri", "below the model's folder");
        glb = triangle();
        glb.root["images"] = {{{"uri", uri}}};
        expect_error(glb, "/images/0/uri", "below the model's folder");
    }
}

TEST(GltfHostile, BuffersBesideTheModel) {
    const TemporaryFolder folder;
    GlbBuilder glb = triangle();
    glb.root["buffers"] = {{{"byteLength", 36}, {"uri", "some%20data.bin"}}};
    folder.write(glb.binary, "some data.bin");
    const std::string text = glb.root.dump();
    const auto path = folder.write({text.begin(), text.end()}, "model.gltf");
    EXPECT_EQ(stage::load_gltf(path).meshes[0].primitives[0].positions.size(), 3u);
}

TEST(GltfHostile, BackslashesOfWindows) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path / "data");
    for (const char* uri : {"data\\some.bin", "data%5Csome.bin", ".\\data\\some.bin"}) {
        GlbBuilder glb = triangle();
        glb.root["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
        folder.write(glb.binary, "data/some.bin");
        const std::string text = glb.root.dump();
        const auto path = folder.write({text.begin(), text.end()}, "model.gltf");
        EXPECT_EQ(stage::load_gltf(path).meshes[0].primitives[0].positions.size(), 3u) << uri;
    }
}

TEST(GltfHostile, Indices) {
    GlbBuilder glb = triangle();
    const std::vector<uint16_t> indices = {0, 1, 3};
    primitive(glb)["indices"] = glb.add(indices, test::kU16, "SCALAR", 1);
    expect_error(glb, "/meshes/0/primitives/0/indices", "element 2 is 3");
    primitive(glb)["indices"] = glb.scalar({0, 1, 2});
    expect_error(glb, "/accessors/2", "unsigned integers");
    primitive(glb)["indices"] = glb.add(std::vector<uint16_t>{0, 1}, test::kU16, "SCALAR", 1);
    expect_error(glb, "/indices", "whole triangles");
    primitive(glb).erase("indices");
    primitive(glb)["mode"] = 7;
    expect_error(glb, "/mode", "triangles");
}

TEST(GltfHostile, NodeGraph) {
    GlbBuilder glb = triangle();
    glb.root["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
    expect_error(glb, "/nodes/0", "ancestor");
    glb.root["nodes"] = {{{"children", {0}}}};
    expect_error(glb, "/nodes/0", "ancestor");
    glb.root["nodes"] = {{{"children", {1, 1}}}, json::object()};
    expect_error(glb, "/nodes/0/children", "two parents");
    glb.root["nodes"] = {{{"children", {7}}}};
    expect_error(glb, "/nodes/0/children", "7 does not exist");
    glb.root["nodes"] = {{{"mesh", 3}}};
    expect_error(glb, "/nodes/0/mesh", "3 does not exist");
    glb.root["nodes"] = {{{"translation", {1, 2}}}};
    expect_error(glb, "/nodes/0/translation", "2 numbers");
    glb.root["nodes"] = {{{"translation", "up"}}};
    expect_error(glb, "/nodes/0/translation", "list of numbers");
    glb.root["nodes"] = {{{"rotation", {0, 0, 0, 0}}}};
    expect_error(glb, "/nodes/0/rotation", "length 0");
    glb.root["nodes"] = {{{"scale", {1e300, 1, 1}}}};
    expect_error(glb, "/nodes/0/scale", "too large");
    glb.root["nodes"] = json::array({"text"});
    EXPECT_NE(error_of(glb), "");
}

TEST(GltfHostile, SkinsAndMorphs) {
    GlbBuilder glb = arm();
    glb.root["skins"][0]["joints"] = {1};
    expect_error(glb, "JOINTS_0", "joint 1 is past the 1");
    glb.root["skins"][0]["joints"] = {1, 9};
    expect_error(glb, "/skins/0/joints", "node 9");
    glb = arm();
    glb.root["skins"][0]["joints"] = {1, 2, 1};
    expect_error(glb, "/skins/0/inverseBindMatrices", "2 matrices for 3");
    glb = arm();
    primitive(glb)["attributes"].erase("WEIGHTS_0");
    expect_error(glb, "/attributes", "only one");
    glb = triangle();
    primitive(glb)["targets"] = {{{"POSITION", glb.vec3({0, 0, 0})}}};
    expect_error(glb, "/targets/0/POSITION", "1 elements for 3 vertices");
    primitive(glb)["targets"] = {json::object()};
    glb.root["meshes"][0]["weights"] = {1, 2};
    expect_error(glb, "/meshes/0/weights", "2 weights for 1");
}

TEST(GltfHostile, Animations) {
    const auto with = [](const std::string& path, const std::string& mode, const std::vector<float>& times,
                         const std::vector<float>& values, size_t components) {
        GlbBuilder glb = triangle();
        const int input = glb.scalar(times);
        animate(glb, path, mode, input, glb.floats(values, components == 4 ? "VEC4" : "VEC3", components));
        return glb;
    };
    expect_error(with("translation", "LINEAR", {0, 0}, {0, 0, 0, 0, 0, 0}, 3), "/samplers/0/input", "ascend");
    expect_error(with("translation", "LINEAR", {0, 1}, {0, 0, 0}, 3), "/samplers/0/output", "2 keys need 6");
    expect_error(with("translation", "CUBICSPLINE", {0}, {0, 0, 0}, 3), "/samplers/0/output", "1 keys need 9");
    expect_error(with("rotation", "LINEAR", {0}, {0, 0, 0, 0}, 4), "/samplers/0/output", "length 0");
    expect_error(with("weights", "LINEAR", {0}, {0, 0, 0}, 3), "/channels/0/target", "no morph targets");
    expect_error(with("colour", "LINEAR", {0}, {0, 0, 0}, 3), "/channels/0/target/path", "translation");
    expect_error(with("translation", "SWIFT", {0}, {0, 0, 0}, 3), "/interpolation", "CUBICSPLINE");
    expect_error(with("translation", "LINEAR", {NAN}, {0, 0, 0}, 3), "/accessors/1", "not finite");
    GlbBuilder glb = with("translation", "LINEAR", {0}, {0, 0, 0}, 3);
    glb.root["animations"][0]["channels"][0]["sampler"] = 4;
    expect_error(glb, "/animations/0/channels/0/sampler", "4 does not exist");
    glb = with("translation", "LINEAR", {0}, {0, 0, 0}, 3);
    glb.root["animations"][0]["channels"][0]["target"]["node"] = 4;
    expect_error(glb, "/animations/0/channels/0/target/node", "4 does not exist");
}

// What tinygltf would say in its own words is said with its place.
TEST(GltfHostile, NamesWhatIsMissing) {
    const auto without = [](const char* pointer, const std::string& place, const std::string& problem) {
        GlbBuilder glb = arm();
        animate(glb, "translation", "LINEAR", glb.scalar({0}), glb.vec3({0, 0, 0}));
        glb.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
        glb.root["images"] = {{{"uri", "x.png"}}};
        glb.root["accessors"][0]["sparse"] = {{"count", 1},
                                              {"indices", {{"bufferView", 0}, {"componentType", test::kU8}}},
                                              {"values", {{"bufferView", 0}}}};
        ASSERT_EQ(error_of(glb), "");
        const json::json_pointer at(pointer);
        ASSERT_TRUE(glb.root.contains(at)) << pointer;
        glb.root[at.parent_pointer()].erase(at.back());
        expect_error(glb, place, problem);
        EXPECT_EQ(error_of(glb).find('`'), std::string::npos) << error_of(glb);
    };
    without("/asset/version", "/asset", "has no version");
    without("/accessors/0/componentType", "/accessors/0", "lacks componentType");
    without("/accessors/0/type", "/accessors/0", "lacks type");
    without("/accessors/0/sparse/indices", "/accessors/0/sparse", "lacks indices");
    without("/accessors/0/sparse/values/bufferView", "/accessors/0/sparse/values", "lacks bufferView");
    without("/animations/0/samplers", "/animations/0", "lacks samplers");
    without("/animations/0/channels/0/sampler", "/animations/0/channels/0", "lacks sampler");
    without("/animations/0/channels/0/target/path", "/animations/0/channels/0/target", "lacks path");
    without("/animations/0/samplers/0/input", "/animations/0/samplers/0", "lacks input");
    without("/bufferViews/0/byteLength", "/bufferViews/0", "lacks byteLength");
    without("/cameras/0/perspective", "/cameras/0", "lacks perspective");
    without("/cameras/0/perspective/yfov", "/cameras/0/perspective", "lacks yfov");
    without("/images/0/uri", "/images/0", "neither uri nor bufferView");
    without("/meshes/0/primitives/0/attributes", "/meshes/0/primitives/0", "lacks attributes");
    without("/skins/0/joints", "/skins/0", "lacks joints");
}

TEST(GltfHostile, NumbersThatAreNone) {
    GlbBuilder glb = triangle();
    primitive(glb)["attributes"]["POSITION"] = glb.vec3({0, 0, 0, INFINITY, 0, 0, 0, 1, 0});
    expect_error(glb, "/accessors/1", "element 1 is not finite");
}

// If each primitive copied the list of accessors, this would take 7 s in place of 0.1 s.
TEST(GltfHostile, ManyMeshesAreChecked) {
    GlbBuilder glb = triangle();
    const json accessor = glb.root["accessors"][0];
    for (int i = 0; i < 2000; ++i) glb.root["accessors"].push_back(accessor);
    primitive(glb)["indices"] = 0;
    const json mesh = glb.root["meshes"][0];
    for (int i = 1; i < 4000; ++i) glb.root["meshes"].push_back(mesh);
    glb.root["meshes"][3999]["primitives"][0]["indices"] = 9999;
    const std::clock_t begin = std::clock();  // of this process: a busy machine changes it little
    expect_error(glb, "/meshes/3999/primitives/0/indices", "accessor 9999 does not exist");
    EXPECT_LT(std::clock() - begin, 3 * CLOCKS_PER_SEC);
}

TEST(GltfHostile, RequiredExtensionsAndDepth) {
    GlbBuilder glb = triangle();
    glb.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    expect_error(glb, "/extensionsRequired", "KHR_draco_mesh_compression");
    const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[');
    EXPECT_NE(error_of({deep.begin(), deep.end()}, "deep.gltf").find("deeper"), std::string::npos);
}

// Every damaged file gives a scene that can be posed, or an InputError.
TEST(GltfHostile, FlippedBytes) {
    GlbBuilder source = arm();
    primitive(source)["targets"] = {{{"POSITION", source.vec3({0, 0, 4, 0, 0, 0, 0, 0, 0})}}};
    animate(source, "weights", "CUBICSPLINE", source.scalar({0, 1}), source.scalar({0, 1, 0, 0, 2, 0}));
    animate(source, "translation", "LINEAR", source.scalar({0, 2}), source.vec3({0, 0, 0, 1, 0, 0}));
    const std::vector<uint8_t> valid = source.bytes();
    ASSERT_EQ(error_of(valid), "");
    const TemporaryFolder folder;
    std::mt19937 random(7);
    int loaded = 0, refused = 0;
    for (int round = 0; round < 1500; ++round) {
        std::vector<uint8_t> bytes = valid;
        for (uint32_t flips = 1 + random() % 4; flips > 0; --flips)
            bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
        try {
            const stage::GltfScene scene = stage::load_gltf(folder.write(bytes));
            stage::bounds_over(scene, scene.animations.empty() ? stage::kNoAnimation : 0, {0, 0.5});
            ++loaded;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(loaded, 100);
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace neuvv::test::gltf_test
