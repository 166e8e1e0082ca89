// neuvv render of a stage, on the command line.
#include <gtest/gtest.h>

#include "media/exr.h"
#include "media/video.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "voctree/files/nvpaint.h"

namespace neuvv {
namespace {

struct CliStage : CliGpu {
    std::string show = file("show.gltf");

    void SetUp() override {
        CliGpu::SetUp();
        edit::Placement raised;
        raised.at = glm::dvec3(0, 0.3, 0);
        test::write_stage(show, scene, "anna", raised);
    }
    static void done(const std::vector<std::string>& arguments) {
        const ProgramResult result = run_neuvv(arguments);
        ASSERT_EQ(result.code, 0) << result.err;
    }
    // A still of 64×48.
    media::Image still(const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {"render", "--overwrite", show, "-o", file("still.png"), "--size", "64x48"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(words);
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("still.png"));
    }
};

TEST_F(CliStage, AVideoIsAsLongAsTheStage) {
    done({"render", "--overwrite", show, "-o", file("show.mp4"), "--size", "64x48", "--fps", "4"});
    const media::VideoSummary whole = media::summarise_video(file("show.mp4"));
    EXPECT_EQ(whole.frames, 8u) << "a clip of four frames at two a second";
    EXPECT_EQ(whole.fps, 4);
    done({"stage", "set", show, "--duration", "3", "--fps", "5"});
    done({"render", "--overwrite", show, "-o", file("part.mp4"), "--size", "64x48", "--time", "1:2.6"});
    EXPECT_EQ(media::summarise_video(file("part.mp4")).frames, 8u);
}

TEST_F(CliStage, EveryEditAndSwitchShows) {
    const media::Image before = still();
    EXPECT_EQ(before.rgba, still().rgba);
    EXPECT_NE(before.rgba, still({"--time", "1"}).rgba);
    EXPECT_NE(before.rgba, still({"--shadows", "off"}).rgba);
    EXPECT_NE(before.rgba, still({"--falloff", "off"}).rgba);
    EXPECT_NE(before.rgba, still({"--orbit"}).rgba);
    EXPECT_NE(before.rgba, still({"--depth"}).rgba);
    done({"stage", "set", show, "anna", "--opacity", "0.4"});
    EXPECT_NE(before.rgba, still().rgba);
    done({"stage", "set", show, "anna", "--opacity", "1"});
    EXPECT_EQ(before.rgba, still().rgba);
    done({"stage", "duplicate", show, "anna", "--row", "0.5"});
    const media::Image pair = still();
    EXPECT_NE(before.rgba, pair.rgba);
    EXPECT_NE(pair.rgba, still({"--blend", "paper"}).rgba) << "they stand in each other";
}

// A --background replaces the image of the environment, but not its light.
TEST_F(CliStage, ABackgroundReplacesTheEnvironment) {
    media::Image sky(16, 8);
    std::fill(sky.rgba.begin(), sky.rgba.end(), uint8_t{255});
    for (size_t i = 0; i < sky.rgba.size(); i += 4) sky.rgba[i] = 40;
    media::write_png(file("sky.png"), sky);
    const media::Image without = still({"--background", "#00ff00"});
    done({"stage", "set", show, "--environment", file("sky.png")});
    const media::Image with = still({"--background", "#00ff00"});
    const size_t top = 4 * 32, floor = 4 * (64 * 46 + 32);  // pixels above the end of the floor, and in front
    EXPECT_NEAR(still().rgba[top], 40, 1);
    for (size_t c = 0; c < 3; ++c) EXPECT_EQ(with.rgba[top + c], c == 1 ? 255 : 0);
    EXPECT_GT(with.rgba[floor + 2], without.rgba[floor + 2]) << "it shines";
}

TEST_F(CliStage, LightsBeyondTheLimitsAreReported) {
    for (int i = 0; i < 5; ++i) done({"stage", "light", show, "--add", "--at", "0,3,0", "--aim", "0,0,0.1"});
    const ProgramResult casting =
        run_neuvv({"render", "--overwrite", show, "-o", file("still.png"), "--size", "16x16"});
    EXPECT_NE(casting.err.find("6 of its lights would cast shadows, of which the first 4 do"), std::string::npos)
        << casting.err;
    for (int i = 0; i < 11; ++i) done({"stage", "light", show, "--add", "--kind", "point", "--at", "0,3,0"});
    const std::vector<std::string> words = {"render", "--overwrite", show,        "-o", file("still_%d.png"),
                                            "--size", "16x16",       "--shadows", "off"};
    const ProgramResult all = run_neuvv(words);
    const size_t said = all.err.find("has 17 lights, of which the first 16 shine");
    EXPECT_NE(said, std::string::npos) << all.err;
    EXPECT_EQ(all.err.find("shine", said + 50), std::string::npos) << "once";
    EXPECT_EQ(all.err.find("shadows"), std::string::npos) << "none are wanted";
}

// --camera path follows the stage's own path in stage time; the default is the first camera.
TEST_F(CliStage, TheStagesPathIsFollowed) {
    const media::Image first = still();
    expect_refused({"render", show, "-o", file("x.png"), "--camera", "path"}, 2, {"path", "camera"});
    done({"stage", "camera", show, "--add", "--name", "left", "--at", "-3,1,2", "--aim", "0,1,0"});
    done({"stage", "path", show, "--key", "0", "--camera", "left"});
    done({"stage", "path", show, "--key", "4", "--camera", "camera"});
    EXPECT_EQ(still().rgba, first.rgba);
    EXPECT_EQ(still({"--camera", "path"}).rgba, still({"--camera", "left"}).rgba);
    EXPECT_EQ(still({"--camera", "path", "--time", "4"}).rgba, still({"--camera", "camera", "--time", "4"}).rgba);
    EXPECT_NE(still({"--camera", "path", "--time", "2"}).rgba, still({"--camera", "camera", "--time", "2"}).rgba);
    done({"render", "--overwrite", show, "-o", file("path.mp4"), "--size", "64x48", "--fps", "2", "--camera", "path"});
    EXPECT_EQ(media::summarise_video(file("path.mp4")).frames, 8u)
        << "as long as the stage, which lasts as long as the path";
    done({"stage", "set", show, "--duration", "1"});
    done({"render", "--overwrite", show, "-o", file("part.mp4"), "--size", "64x48", "--fps", "2", "--camera", "path"});
    EXPECT_EQ(media::summarise_video(file("part.mp4")).frames, 2u);
}

TEST_F(CliStage, WhatIsHiddenIsNotDrawn) {
    const media::Image before = still();
    done({"stage", "set", show, "floor", "--shown", "off"});
    const media::Image floorless = still();
    EXPECT_NE(before.rgba, floorless.rgba);
    done({"stage", "set", show, "anna", "--shown", "off"});
    const media::Image empty = still();
    EXPECT_NE(floorless.rgba, empty.rgba);
    for (size_t i = 4; i < empty.rgba.size(); ++i) ASSERT_EQ(empty.rgba[i], empty.rgba[i % 4]) << "nothing is left";
    for (const char* node : {"floor", "anna"}) done({"stage", "set", show, node, "--shown", "on"});
    EXPECT_EQ(before.rgba, still().rgba);
}

// A stage without a camera is rendered on an orbit around it.
TEST_F(CliStage, OrthographicCamerasAreAsNone) {
    std::string text = read_text(show);
    const auto begin = text.find("\"type\": \"perspective\""), end = text.find('}', begin);
    text.replace(begin, end - begin + 1,
                 R"("type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0})");
    write_text(show, text);
    const media::Image seen = still();
    EXPECT_EQ(seen.rgba, still({"--orbit"}).rgba);
}

// The error for paint that no longer fits its clip names the node and the index in its list.
TEST_F(CliStage, PaintThatDoesNotFitIsNamed) {
    voctree::write_paint(file("red.nvpaint"), {voctree::painted_field(tree), {}});
    done({"stage", "paint", show, "anna", "--add", file("red.nvpaint")});
    voctree::write_nvv(scene, test::random_tree({.leaves = 90, .frames = 4}));
    const ProgramResult result = run_neuvv({"render", "--overwrite", show, "-o", file("x.png"), "--size", "16x16"});
    EXPECT_EQ(result.code, 2);
    for (const char* part : {"show.gltf", "\"anna\": paint layer 0", "red.nvpaint", "another scene"})
        EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
}

TEST_F(CliStage, LinearImagesHoldTheSetAndItsDepth) {
    done({"stage", "set", show, "--background", "0.25,0.25,0.25"});
    const media::Image shown = still();
    done({"render", "--overwrite", show, "-o", file("still.exr"), "--size", "64x48"});
    const media::LinearImage linear = media::read_exr(file("still.exr"));
    ASSERT_EQ(linear.width, 64u);
    size_t off = 0, floor = 0;
    for (size_t i = 0; i < linear.depth_m.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) {
            const float light = linear.rgba[4 * i + c];
            const double byte = 255 * media::srgb_from_linear(std::min(1.0, static_cast<double>(light)));
            off += std::abs(byte - shown.rgba[4 * i + c]) > 1;
        }
        floor += std::isfinite(linear.depth_m[i]);
    }
    EXPECT_LE(off, linear.rgba.size() / 500);
    EXPECT_GT(floor, linear.depth_m.size() / 4) << "the floor is seen, and has depth";
    EXPECT_LT(floor, linear.depth_m.size()) << "above it there is none";
}

TEST_F(CliStage, WhatCannotBeRenderedIsRefused) {
    const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& parts) {
        std::vector<std::string> words = {"render", "--overwrite", show, "-o", file("x.mp4")};
        words.insert(words.end(), more.begin(), more.end());
        expect_refused(words, 2, parts);
    };
    refused({"--camera", "nobody"}, {"nobody", "camera"});
    refused({"--time", "2:1"}, {"--time", "2:1"});
    refused({"--time", "nan"}, {"--time"});
    for (const char* time : {"99", "2.5:3"})
        refused({"--time", time}, {"--time: ", "show.gltf changes after 2 s", "0 to 2", "loop"});
    refused({"--frames", "0"}, {"--frames", "clips"});
    refused({"--direct"}, {"--direct"});
    expect_refused({"render", scene, "-o", file("x.mp4"), "--time", "1"}, 2, {"--time", "stages"});
    std::filesystem::remove(scene);
    refused({}, {"anna", "scene.nvv"});
}

}  // namespace
}  // namespace neuvv
