// Splats in glTF and OpenUSD, read back by small readers of their own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/platform.h"
#include "interchange/splats/splat_gltf.h"
#include "interchange/splats/splat_usd.h"
#include "interchange/stage/stand_ins.h"
#include "stage/stage.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "tests/stage/stage_files.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using interchange::Splats;
using nlohmann::json;

std::vector<Splats> three_frames() {
    const voctree::VOctree tree = random_tree({.leaves = 60, .frames = 3});
    std::vector<Splats> frames;
    for (uint32_t i = 0; i < 3; ++i) {
        const glm::dquat turned = glm::normalize(glm::dquat(1, 0.2, 0, 0.1));
        frames.push_back(interchange::splats_of(voctree::slice_of(tree, i), {}, turned));
    }
    return frames;
}

// A binary glTF, as its specification has it.
struct GlbReader {
    json head;
    std::vector<uint8_t> bytes;
    size_t data = 0;

    explicit GlbReader(const std::filesystem::path& file) : bytes(read_file(file)) {
        EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "glTF");
        EXPECT_EQ(u32(4), 2u);
        EXPECT_EQ(u32(8), bytes.size());
        EXPECT_EQ(u32(16), 0x4E4F534Au);
        const size_t length = u32(12);
        EXPECT_EQ(length % 4, 0u);
        head = json::parse(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(length));
        EXPECT_EQ(u32(20 + length), head["buffers"][0]["byteLength"]);
        EXPECT_EQ(u32(24 + length), 0x004E4942u);
        data = 28 + length;
    }
    uint32_t u32(size_t at) const {
        uint32_t value = 0;
        std::memcpy(&value, &bytes.at(at + 3) - 3, 4);
        return value;
    }
    // The numbers of an accessor of floats, and how many belong to an element.
    std::vector<float> floats(const json& index, size_t components) const {
        const json& accessor = head["accessors"][index.get<size_t>()];
        static const char* const kTypes[] = {"", "SCALAR", "", "VEC3", "VEC4"};
        EXPECT_EQ(accessor["type"], kTypes[components]);
        EXPECT_EQ(accessor["componentType"], 5126);
        const json& view = head["bufferViews"][accessor["bufferView"].get<size_t>()];
        const size_t count = components * accessor["count"].get<size_t>(), begin = view["byteOffset"];
        EXPECT_EQ(view["byteLength"], count * sizeof(float));
        EXPECT_EQ(begin % 4, 0u);
        std::vector<float> numbers(count);
        std::memcpy(numbers.data(), &bytes.at(data + begin), count * sizeof(float));
        return numbers;
    }
};

TEST(SplatFiles, GltfHasEveryFrame) {
    const std::vector<Splats> frames = three_frames();
    const TemporaryFolder folder;
    interchange::write_splat_glb(folder.path / "x.glb", frames, 25);
    const GlbReader glb(folder.path / "x.glb");
    EXPECT_EQ(glb.head["extensionsUsed"], json({"KHR_gaussian_splatting"}));
    ASSERT_EQ(glb.head["nodes"].size(), 3u);
    for (size_t f = 0; f < 3; ++f) {
        const json& primitive = glb.head["meshes"][glb.head["nodes"][f]["mesh"].get<size_t>()]["primitives"][0];
        EXPECT_EQ(primitive["mode"], 0);
        EXPECT_EQ(primitive["extensions"]["KHR_gaussian_splatting"]["kernel"], "ellipse");
        const json& attributes = primitive["attributes"];
        const auto positions = glb.floats(attributes["POSITION"], 3);
        const auto scales = glb.floats(attributes["KHR_gaussian_splatting:SCALE"], 3);
        const auto rotations = glb.floats(attributes["KHR_gaussian_splatting:ROTATION"], 4);
        const auto opacities = glb.floats(attributes["KHR_gaussian_splatting:OPACITY"], 1);
        const auto last = glb.floats(attributes["KHR_gaussian_splatting:SH_DEGREE_1_COEF_2"], 3);
        ASSERT_EQ(opacities.size(), frames[f].splats.size());
        for (size_t i = 0; i < opacities.size(); ++i) {
            const interchange::Splat& splat = frames[f].splats[i];
            EXPECT_EQ(opacities[i], splat.opacity);
            for (size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(positions[3 * i + c], splat.centre[static_cast<int>(c)]);
                EXPECT_EQ(scales[3 * i + c], splat.deviation[static_cast<int>(c)]);
                EXPECT_EQ(last[3 * i + c], splat.colour[3][static_cast<int>(c)]);
            }
            EXPECT_NEAR(rotations[4 * i + 3], splat.rotation.w, 1e-6);
            EXPECT_NEAR(rotations[4 * i], splat.rotation.x, 1e-6);
        }
    }
}

// Floats of a mesh hold no easting of UTM, but the numbers of JSON and USD do.
TEST(SplatFiles, StandInTheirCapture) {
    const glm::dvec3 origin(512350.125, 410, -5403210.0625);
    const TemporaryFolder folder;
    interchange::write_splat_glb(folder.path / "x.glb", three_frames(), 25, origin);
    const GlbReader glb(folder.path / "x.glb");
    ASSERT_EQ(glb.head["nodes"].size(), 4u);
    const size_t root = glb.head["scenes"][0]["nodes"][0];
    EXPECT_EQ(glb.head["scenes"][0]["nodes"].size(), 1u);
    EXPECT_EQ(glb.head["nodes"][root]["children"], json({0, 1, 2}));
    for (size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(glb.head["nodes"][root]["translation"][axis].get<double>(), origin[static_cast<int>(axis)]);
    interchange::write_splat_usda(folder.path / "x.usda", three_frames(), 25, origin);
    EXPECT_NE(read_text(folder.path / "x.usda")
                  .find("    double3 xformOp:translate = (512350.125, 410, -5403210.0625)\n"
                        "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n"),
              std::string::npos);
}

// At the middle of each frame's time, its node alone has a size.
TEST(SplatFiles, GltfShowsOneFrameAfterTheOther) {
    const TemporaryFolder folder;
    interchange::write_splat_glb(folder.path / "x.glb", three_frames(), 25);
    const GlbReader glb(folder.path / "x.glb");
    const json& animation = glb.head["animations"][0];
    for (int shown = 0; shown < 3; ++shown)
        for (const json& channel : animation["channels"]) {
            const json& sampler = animation["samplers"][channel["sampler"].get<size_t>()];
            EXPECT_EQ(sampler["interpolation"], "STEP");
            EXPECT_EQ(channel["target"]["path"], "scale");
            const auto times = glb.floats(sampler["input"], 1), scales = glb.floats(sampler["output"], 3);
            ASSERT_EQ(scales.size(), 3 * times.size());
            size_t key = 0;
            for (size_t i = 0; i < times.size(); ++i) {
                if (i > 0) {
                    EXPECT_LT(times[i - 1], times[i]);
                }
                if (times[i] <= (static_cast<float>(shown) + 0.5f) / 25) key = i;
            }
            EXPECT_EQ(scales[3 * key], channel["target"]["node"] == shown ? 1.0f : 0.0f);
        }
}

TEST(SplatFiles, GltfMayHaveEmptyFrames) {
    std::vector<Splats> frames = three_frames();
    frames[1].splats.clear();
    const TemporaryFolder folder;
    interchange::write_splat_glb(folder.path / "x.glb", frames, 25);
    const GlbReader glb(folder.path / "x.glb");
    EXPECT_EQ(glb.head["meshes"].size(), 2u);
    EXPECT_FALSE(glb.head["nodes"][1].contains("mesh"));
}

// Splats stand in for a performer twice, turned the second time, in a stage of another program.
TEST(StandIns, AreBelowTheNodesOfPerformers) {
    const TemporaryFolder folder;
    const std::vector<Splats> splats = three_frames();
    const stage::Stage before = stage::load_stage(put_foreign_stage(folder.path));
    const uint32_t anna = before.performers[0].node;
    const std::vector<interchange::StandIn> all = {{anna, 1}, {0, 1, {0, 0, 1, 0}}, {1, 2}};
    EXPECT_FALSE(interchange::has_stand_ins(before));
    interchange::write_stand_ins(folder.path / "x.glb", before, {splats.data(), 3}, all);
    const GlbReader glb(folder.path / "x.glb");
    const json &nodes = glb.head["nodes"], &meshes = glb.head["meshes"];
    ASSERT_EQ(nodes.size(), before.scene.nodes.size() + 3);
    ASSERT_EQ(meshes.size(), 4u);
    const json& below_anna = nodes[nodes[anna]["children"].back().get<size_t>()];
    EXPECT_EQ(below_anna, json({{"name", "Anna stand-in"}, {"mesh", 2}}));
    EXPECT_EQ(nodes[nodes[0]["children"].back().get<size_t>()]["rotation"], json({0.0, 1.0, 0.0, 0.0}));
    EXPECT_EQ(nodes[nodes[1]["children"].back().get<size_t>()]["mesh"], 3);
    const json& attributes = meshes[2]["primitives"][0]["attributes"];
    const auto positions = glb.floats(attributes["POSITION"], 3);
    ASSERT_EQ(positions.size(), 3 * splats[1].splats.size());
    EXPECT_EQ(positions[4], splats[1].splats[1].centre.y);
    const json& used = glb.head["extensionsUsed"];
    EXPECT_EQ(std::count(used.begin(), used.end(), "KHR_gaussian_splatting"), 1);
}

TEST(StandIns, LeaveTheStageAsItIs) {
    const TemporaryFolder folder;
    const std::vector<Splats> splats = three_frames();
    const stage::Stage before = stage::load_stage(put_foreign_stage(folder.path));
    const interchange::StandIn one{before.performers[0].node, 0, {1, 0, 0, 0}};
    std::filesystem::create_directories(folder.path / "below");
    interchange::write_stand_ins(folder.path / "below/x.glb", before, {splats.data(), 1}, {&one, 1});
    const stage::Stage after = stage::load_stage(folder.path / "below/x.glb");
    EXPECT_TRUE(interchange::has_stand_ins(after));
    EXPECT_EQ(after.clips[0].path, before.clips[0].path);
    EXPECT_EQ(after.performers[0].node, before.performers[0].node);
    EXPECT_TRUE(after.scene.meshes[1].primitives.empty()) << "splats are not drawn as a part of the set";
    EXPECT_EQ(after.scene.meshes[0].primitives[0].positions, before.scene.meshes[0].primitives[0].positions);
}

// Adding arrays adds members to a document that has none, however many others it has.
TEST(StandIns, AreAddedToStagesWithoutArrays) {
    const TemporaryFolder folder;
    const std::vector<Splats> splats = three_frames();
    test::put_clip(folder.path / "anna.nvv");
    std::string more;
    for (int members = 0; members < 8; ++members) {
        const std::string text = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [
            {"extensions": {"NEUVV_performer": {"uri": "anna.nvv"}}}])" +
                                 more + "}";
        write_text(folder.path / "a.gltf", text);
        const interchange::StandIn one{0, 0, {1, 0, 0, 0}};
        interchange::write_stand_ins(folder.path / "x.glb", stage::load_stage(folder.path / "a.gltf"),
                                     {splats.data(), 1}, {&one, 1});
        const GlbReader glb(folder.path / "x.glb");
        ASSERT_EQ(glb.head["meshes"].size(), 1u) << members;
        EXPECT_EQ(glb.head["extensionsUsed"], json({"KHR_gaussian_splatting"}));
        EXPECT_TRUE(interchange::has_stand_ins(stage::load_stage(folder.path / "x.glb")));
        more += fmt::format(R"(, "m{}": 0)", members);
    }
}

// All numbers between the brackets behind `name`, at a time code or, with none, of the attribute itself.
std::vector<double> usd_numbers(const std::string& text, const std::string& name, int time = -1) {
    size_t at = text.find(" " + name + (time < 0 ? " = [" : ".timeSamples = {"));
    EXPECT_NE(at, std::string::npos) << name;
    if (time >= 0) at = text.find(" " + std::to_string(time) + ": [", at);
    at = text.find('[', at);
    std::string part = text.substr(at + 1, text.find(']', at) - at - 1);
    for (char& c : part)
        if (c == '(' || c == ')' || c == ',') c = ' ';
    std::istringstream in(part);
    std::vector<double> numbers;
    for (double number = 0; in >> number;) numbers.push_back(number);
    EXPECT_TRUE(in.eof()) << part.substr(0, 100);
    return numbers;
}

void expect_usd(const std::string& text, const Splats& splats, int time) {
    const size_t count = splats.splats.size(), harmonics = sh_count(splats.degree);
    const auto positions = usd_numbers(text, "positions", time), scales = usd_numbers(text, "scales", time);
    const auto orientations = usd_numbers(text, "orientations", time), opacities = usd_numbers(text, "opacities", time);
    const auto colours = usd_numbers(text, "radiance:sphericalHarmonicsCoefficients", time);
    ASSERT_EQ(positions.size(), 3 * count);
    ASSERT_EQ(scales.size(), 3 * count);
    ASSERT_EQ(orientations.size(), 4 * count);
    ASSERT_EQ(opacities.size(), count);
    ASSERT_EQ(colours.size(), 3 * harmonics * count);
    const auto extent = usd_numbers(text, "extent", time);
    for (size_t i = 0; i < count; ++i) {
        const interchange::Splat& splat = splats.splats[i];
        EXPECT_NEAR(opacities[i], double{splat.opacity}, 1e-5);
        EXPECT_NEAR(orientations[4 * i], splats.splats[i].rotation.w, 1e-5);
        EXPECT_NEAR(orientations[4 * i + 3], splats.splats[i].rotation.z, 1e-5);
        for (size_t c = 0; c < 3; ++c) {
            const int axis = static_cast<int>(c);
            EXPECT_NEAR(positions[3 * i + c], double{splat.centre[axis]}, 1e-5);
            EXPECT_NEAR(scales[3 * i + c], double{splat.deviation[axis]}, 1e-6);
            EXPECT_LE(extent[c], double{splat.centre[axis] - splat.deviation[axis]});
            EXPECT_GE(extent[3 + c], double{splat.centre[axis] + splat.deviation[axis]});
            for (size_t k = 0; k < harmonics; ++k)
                EXPECT_NEAR(colours[3 * (i * harmonics + k) + c], double{splat.colour[k][axis]}, 1e-5);
        }
    }
}

TEST(SplatFiles, UsdHasSamplesOfEveryFrame) {
    const std::vector<Splats> frames = three_frames();
    const TemporaryFolder folder;
    interchange::write_splat_usda(folder.path / "x.usda", frames, 25);
    const std::string text = read_text(folder.path / "x.usda");
    EXPECT_EQ(text.rfind("#usda 1.0\n", 0), 0u);
    for (const char* part :
         {"endTimeCode = 2\n", "timeCodesPerSecond = 25\n", "upAxis = \"Y\"", "elementSize = 4\n",
          "def ParticleField3DGaussianSplat \"Splats\"", "uniform int radiance:sphericalHarmonicsDegree = 1\n"})
        EXPECT_NE(text.find(part), std::string::npos) << part;
    for (int i = 0; i < 3; ++i) expect_usd(text, frames[static_cast<size_t>(i)], i);
    interchange::write_splat_usda(folder.path / "one.usda", std::span(frames).first(1), 25);
    expect_usd(read_text(folder.path / "one.usda"), frames[0], -1);
}

}  // namespace
}  // namespace neuvv::test
