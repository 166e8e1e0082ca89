// Clips in segments, on the command line: they are what the same clip as one file is.
#include <gtest/gtest.h>

#include "render/clips/stage_renderer.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_segments.h"
#include "tests/tools/image_distance.h"

namespace neuvv {
namespace {

TEST_F(CliSegments, OnAStageTheyPlayAsOneFileDoes) {
    for (const char* time : {"0", "0.5", "0.75", "1.5"})
        EXPECT_EQ(still(parts, time).rgba, still(scene, time).rgba) << time;
    EXPECT_NE(still(parts, "0").rgba, still(parts, "1").rgba);
    EXPECT_EQ(still(parts, "0.1").rgba, still(parts, "0").rgba) << "before the first frame of the next segment";
}

TEST_F(CliSegments, SlowMotionGoesOnThroughTheirOverlap) {
    const std::string smooth = file("smooth.nvv");
    write_segmented_copy(tree, {1, 3}, smooth, 1);
    for (const char* time : {"0", "1", "1.5"}) EXPECT_EQ(still(smooth, time).rgba, still(scene, time).rgba) << time;
    EXPECT_NE(still(smooth, "0.1").rgba, still(smooth, "0").rgba);
    EXPECT_NE(still(smooth, "0.2").rgba, still(smooth, "0.1").rgba);
}

// Both segments of these clips show the same at the frames that they share, so that a fade between them is no change;
// where one shows something else, it is a part of each.
TEST_F(CliSegments, TheyFadeIntoEachOther) {
    const std::string fading = file("fading.nvv"), other = file("other.nvv");
    write_segmented_copy(tree, {1, 3}, fading, 2);
    voctree::VOctree negative = tree;
    for (float& weight : negative.weights) weight = -weight;
    write_segmented_copy(negative, {1, 3}, other, 2);
    const media::Image whole = still(scene, "0.5");
    EXPECT_LT(distance(still(fading, "0.5"), whole), 0.2);
    const auto rendered = [&](const std::string& clip) {
        EXPECT_EQ(
            run_neuvv({"render", clip, "-o", file("clip.png"), "--size", "64x48", "--frames", "1", "--overwrite"}).code,
            0);
        return media::read_png(file("clip.png"));
    };
    const media::Image clip = rendered(parts);  // whose box, and so whose orbit, is that of other segmented clips
    EXPECT_LT(distance(rendered(fading), clip), 0.2);
    std::filesystem::copy_file(other + "/000000.nvv", fading + "/000000.nvv",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_GT(distance(still(fading, "0.5"), whole), 1) << "two thirds of it are the other tree";
    EXPECT_GT(distance(rendered(fading), clip), 1);
    EXPECT_EQ(still(fading, "1.5").rgba, still(scene, "1.5").rgba) << "behind the fade";
    write_own_data();
    EXPECT_LT(eval(fading).at("frames")[1].at("psnr"), eval(scene).at("frames")[1].at("psnr").get<double>() - 3);
}

TEST_F(CliSegments, TheyMeasureAsOneFileDoes) {
    write_own_data();
    const nlohmann::json one = eval(scene), many = eval(parts);
    EXPECT_EQ(many.at("psnr"), one.at("psnr"));
    EXPECT_EQ(many.at("frames"), one.at("frames"));
    EXPECT_EQ(many.at("images"), one.at("images"));
}

TEST_F(CliSegments, TheyAreMadeSmallerOneByOne) {
    const ProgramResult run =
        run_neuvv({"convert", "--overwrite", parts, "-o", file("small.nvv"), "--quality", "35", "--size", "48x36"});
    ASSERT_EQ(run.code, 0) << run.err;
    const voctree::ClipIndex before = voctree::read_clip_index(parts),
                             index = voctree::read_clip_index(file("small.nvv"));
    ASSERT_EQ(index.segments.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(index.segments[i].frames, before.segments[i].frames);
        EXPECT_LT(std::filesystem::file_size(index.segments[i].file),
                  std::filesystem::file_size(before.segments[i].file));
    }
    EXPECT_NE(still(file("small.nvv"), "1").rgba, still(file("small.nvv"), "0").rgba);
    expect_refused({"convert", parts, "-o", file("small.nvv")}, 2, {"small.nvv", "is there already"});
    std::filesystem::remove(parts + "/000001.nvv");
    expect_refused({"convert", parts, "-o", file("other.nvv")}, 2, {"000001.nvv"});
}

TEST_F(CliSegments, InfoNamesWhatCannotBePlayed) {
    const ProgramResult sound = run_neuvv({"info", parts, "--check"});
    ASSERT_EQ(sound.code, 0) << sound.err;
    EXPECT_NE(sound.out.find("4 frames at 2 fps, 2.00 s"), std::string::npos) << sound.out;
    const std::string second = parts + "/000001.nvv";
    write_text(second, read_text(second).substr(0, 200));
    const ProgramResult damaged = run_neuvv({"info", parts, "--json"});
    ASSERT_EQ(damaged.code, 0) << damaged.err;
    const auto segments = nlohmann::json::parse(damaged.out).at("segments");
    EXPECT_FALSE(segments[0].contains("problem"));
    EXPECT_NE(segments[1].at("problem").get<std::string>().find("000001.nvv"), std::string::npos);
    expect_refused({"info", parts, "--check"}, 2, {"parts.nvv", "cannot be played"});
    expect_refused({"render", parts, "-o", file("x.png"), "--frames", "2"}, 2, {"000001.nvv"});
    ASSERT_EQ(run_neuvv({"render", "--overwrite", parts, "-o", file("x.png"), "--frames", "0", "--size", "16x16"}).code,
              0)
        << "the other segment is whole";
}

// The same file as a part of a clip and alone is one field, also after an edit.
TEST_F(CliSegments, AStageMayHaveASegmentTwice) {
    const std::string show = file("show.gltf");
    test::write_stage(show, parts, "anna");
    ASSERT_EQ(run_neuvv({"stage", "add", show, parts + "/000001.nvv", "--name", "ben", "--at", "1,0,0"}).code, 0);
    const gpu::Device& gpu = device();
    const auto first = stage::load_stage(show);
    render::StageLoader loader(gpu);
    render::StageRenderer renderer(gpu, first, loader.load(first), {64, 48});
    ASSERT_EQ(run_neuvv({"stage", "set", show, "ben", "--at", "2,0,0"}).code, 0);
    const auto second = stage::load_stage(show);
    renderer.change(second, loader.load(second));
    const auto evaluated = stage::stage_at(second, 1);
    renderer.show(evaluated);
    const stage::Camera camera =
        tools::orbit_path(stage::performers_box(second, evaluated), {{0, 0}, 2, 2}, {64, 48})[0].camera;
    const media::Image both = renderer.frames().render(camera, renderer.settings_at(evaluated));
    render::StageRenderer fresh(gpu, second, render::StageLoader(gpu).load(second), {64, 48});
    fresh.show(evaluated);
    EXPECT_EQ(both.rgba, fresh.frames().render(camera, fresh.settings_at(evaluated)).rgba);
}

}  // namespace
}  // namespace neuvv
