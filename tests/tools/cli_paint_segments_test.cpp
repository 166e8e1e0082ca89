// Paint on clips in segments, on the command line: it is what paint on the same clip as one file is.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "tests/tools/image_distance.h"

namespace neuvv {
namespace {

std::vector<std::string> with(std::vector<std::string> list, const std::vector<std::string>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
}

// Cut in two ways, with the leaves of the one file that live in a segment, so that what is painted must be the same,
// however it spreads. Where two segments fade into each other, they are two instances, which rounds differently.
struct PaintedSegments : CliGpu {
    std::vector<std::string> clips = {scene, file("cut0.nvv"), file("cut1.nvv")};
    std::vector<std::vector<media::Image>> plain;  // of each clip, each frame

    void SetUp() override {
        CliGpu::SetUp();
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 40;
        voctree::write_nvv(scene, tree);
        for (const uint32_t overlap : {0u, 1u}) write_segmented_copy(tree, {1, 2, 1}, clips[1 + overlap], overlap);
        media::Image red(20, 20);
        for (size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i] = red.rgba[i + 3] = 255;
        media::write_png(file("red.png"), red);
        for (const std::string& clip : clips) plain.push_back(stills(clip, {}));
    }
    // All frames of a clip on a stage, painted by this call without scene and layer; not painted where it is empty.
    std::vector<media::Image> stills(const std::string& clip, std::vector<std::string> call) {
        const std::string show = file("show.gltf"), layer = file("layer.nvpaint");
        std::filesystem::remove_all(layer);
        test::write_stage(show, clip, "anna");
        if (!call.empty()) {
            call.insert(call.begin() + 1, {show, layer});
            const ProgramResult run = run_neuvv(with({"paint"}, call));
            EXPECT_EQ(run.code, 0) << run.err;
            EXPECT_EQ(std::filesystem::is_directory(layer), clip != scene);
        }
        const ProgramResult run = run_neuvv({"render", "--overwrite", show, "-o", file("still%04d.png"), "--size",
                                             "64x48", "--time", "0:2", "--fps", "2"});
        EXPECT_EQ(run.code, 0) << run.err;
        std::vector<media::Image> images;
        for (const char* name : {"still0000.png", "still0001.png", "still0002.png", "still0003.png"})
            images.push_back(media::read_png(file(name)));
        return images;
    }
    void expect_same(const std::vector<std::string>& call) {
        const std::vector<media::Image> one = stills(scene, call);
        double shown = 0;
        for (size_t i = 0; i < one.size(); ++i) shown += distance(one[i], plain[0][i]);
        EXPECT_GT(shown, 1) << fmt::format("{}", fmt::join(call, " "));
        for (size_t c = 1; c < clips.size(); ++c) {
            const std::vector<media::Image> many = stills(clips[c], call);
            for (size_t i = 0; i < one.size(); ++i)
                EXPECT_LE(distance(many[i], one[i]), distance(plain[c][i], plain[0][i]))
                    << clips[c] << ", frame " << i << ": " << fmt::format("{}", fmt::join(call, " "));
        }
    }
    std::vector<std::string> brush = {"brush", "--line",   "20,24",   "50,24",    "--size",
                                      "64x48", "--colour", "#00ff00", "--radius", "0.3"};
};

TEST_F(PaintedSegments, RegionsAreThoseOfOneFile) {
    expect_same({"region", "--colour", "#ff0000", "--box", "-9,-9,-9,0,9,9"});
    expect_same({"region", "--hue", "90", "--box", "-9,-9,-9,9,9,9", "--frames", "1:2"});
    expect_same({"erase", "--sphere", "0.4,0.4,0.4,0.5", "--frames", "2:3"});
    expect_same({"region", "--colour", "#0000ff", "--box", "-9,-9,-9,9,9,9", "--at", "3", "--follow", "run"});
}

TEST_F(PaintedSegments, BrushAndImageGoOnOverCuts) {
    expect_same(brush);
    expect_same(with(brush, {"--at", "1", "--follow", "run"}));
    expect_same(with(brush, {"--at", "3", "--follow", "all", "--alpha", "0.5"}));
    expect_same(with(brush, {"--at", "2", "--frames", "0:1"}));
    expect_same({"project", "--image", file("red.png"), "--at", "2"});
    expect_same({"project", "--image", file("red.png"), "--every-frame", "--frames", "0:2"});
}

TEST_F(PaintedSegments, PaintIsAFolder) {
    const std::string parts = file("parts.nvv");
    write_segmented_copy(tree, {1, 3}, parts);
    const std::string layer = file("look.nvpaint");
    const auto image = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"render", "--overwrite", parts,      "-o", file("x.png"),
                                              "--size", "40x40",       "--frames", "2"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_EQ(run_neuvv(arguments).code, 0);
        return media::read_png(file("x.png"));
    };
    expect_refused({"paint", "info", parts, layer}, 2, {"look.nvpaint", "no such folder"});
    const ProgramResult erased =
        run_neuvv({"paint", "erase", parts, layer, "--box", "-9,-9,-9,9,9,9", "--frames", "2", "--json"});
    ASSERT_EQ(erased.code, 0) << erased.err;
    EXPECT_EQ(nlohmann::json::parse(erased.out).at("segments"), 1);
    EXPECT_FALSE(std::filesystem::exists(layer + "/000000.nvpaint")) << "nothing is painted there";
    const media::Image bare = image({}), gone = image({"--paint", layer});
    EXPECT_NE(gone.rgba, bare.rgba);
    for (size_t i = 3; i < gone.rgba.size(); i += 4) ASSERT_EQ(gone.rgba[i], 0);
    EXPECT_EQ(image({"--paint", layer + ":normal:0"}).rgba, bare.rgba);

    const std::string show = file("show.gltf");
    test::write_stage(show, parts, "anna");
    ASSERT_EQ(run_neuvv({"stage", "paint", show, "anna", "--add", layer}).code, 0);
    const ProgramResult restored = run_neuvv({"paint", "restore", parts, layer, "--box", "-9,-9,-9,9,9,9"});
    ASSERT_EQ(restored.code, 0) << restored.err;
    EXPECT_EQ(image({"--paint", layer}).rgba, bare.rgba);

    // A damaged part costs the paint of its segment alone on a stage, and is named.
    write_text(layer + "/000001.nvpaint", "no paint");
    expect_refused({"render", "--overwrite", parts, "-o", file("x.png"), "--paint", layer, "--frames", "2"}, 2,
                   {"000001.nvpaint"});
    expect_refused({"paint", "info", parts, layer}, 2, {"000001.nvpaint"});
    const ProgramResult shown =
        run_neuvv({"render", "--overwrite", show, "-o", file("x.png"), "--size", "16x16", "--time", "1"});
    EXPECT_EQ(shown.code, 0) << shown.err;
    EXPECT_NE(shown.err.find("000001.nvpaint"), std::string::npos) << shown.err;
    expect_refused({"render", "--overwrite", parts, "-o", file("x.png"), "--paint", scene}, 2,
                   {"scene.nvv", "is a folder"});
    expect_refused({"paint", "erase", parts, scene, "--box", "-9,-9,-9,9,9,9"}, 2, {"scene.nvv"});
    expect_refused({"paint", "erase", scene, layer, "--box", "-9,-9,-9,9,9,9"}, 2, {"look.nvpaint", "folder"});
}

}  // namespace
}  // namespace neuvv
