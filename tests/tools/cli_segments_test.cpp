// Clips in segments, on the command line: they are what the same clip as one file is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <sstream>
#include <thread>

#include "base/seconds.h"
#include "render/clips/stage_renderer.h"
#include "support/child_process.h"
#include "support/mpirun.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "tests/tools/image_distance.h"
#include "training/rig/rig_file.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"
#include "voctree/files/clip.h"

namespace neuvv {
namespace {

struct CliSegments : CliGpu {
    std::string parts = file("parts.nvv");

    void SetUp() override {
        CliGpu::SetUp();
        write_segmented_copy(tree, {1, 3}, parts);
    }
    media::Image still(const std::string& clip, const char* time) {
        const std::string show = file("show.gltf");
        test::write_stage(show, clip, "anna");
        const ProgramResult result =
            run_neuvv({"render", show, "-o", file("still.png"), "--size", "64x48", "--time", time, "--overwrite"});
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("still.png"));
    }
    // The first frames of the segments that have lines in log.jsonl.
    std::set<int> segments_logged() const {
        std::set<int> first;
        std::istringstream lines(read_text(file("log.jsonl")));
        for (std::string line; std::getline(lines, line);)
            first.insert(nlohmann::json::parse(line).at("first_frame").get<int>());
        return first;
    }
    nlohmann::json eval(const std::string& clip) {
        const ProgramResult result =
            run_neuvv({"eval", "--overwrite", clip, file("data"), "--samples", "1", "--json", "-"});
        EXPECT_EQ(result.code, 0) << result.err;
        return nlohmann::json::parse(result.out);
    }
};

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

TEST_F(CliSegments, TrainingGivesThemAnOverlap) {
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";
    ASSERT_EQ(
        run_neuvv({"capture", model, "-o", file("cap"), "--cameras", "5", "--frames", "8", "--size", "32x32"}).code, 0);
    const std::string show = file("show.nvv");
    const ProgramResult run =
        run_neuvv({"train", file("cap"), "-o", show, "--segment", "4", "--steps", "9", "--resolution", "32"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.out.find("after 5 steps"), std::string::npos) << "five of the nine frames to learn: " << run.out;
    EXPECT_NE(run.out.find("after 4 steps"), std::string::npos) << run.out;
    const voctree::ClipIndex index = voctree::read_clip_index(show);
    ASSERT_EQ(index.segments.size(), 2u);
    EXPECT_EQ(index.frames(), 8u);
    EXPECT_EQ(index.segments[0].overlap, 1u);
    EXPECT_EQ(voctree::read_segment(index.segments[0]).frames, 5u) << "and the next segment's first";
    EXPECT_EQ(voctree::read_segment(index.segments[1]).frames, 4u);
    // "auto" is a second, of 25 frames here, but fewer frames than there are bases.
    const auto segments_of_plan = [&](const char* bases) {
        EXPECT_EQ(
            run_neuvv({"train", file("cap"), "-o", file("plan.nvv"), "--segment", "auto", "--plan", "--bases", bases})
                .code,
            0);
        return voctree::read_clip_index(file("plan.nvv")).segments.size();
    };
    EXPECT_EQ(segments_of_plan("31"), 1u);
    EXPECT_EQ(segments_of_plan("5"), 3u);
    EXPECT_EQ(segments_of_plan("1"), 8u);
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

TEST_F(CliSegments, TrainingMakesThemOneAfterTheOther) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const std::string show = file("show.nvv");
    const std::vector<std::string> command = {
        "train", file("data"),   "-o", show,        "--segment",       "2",         "--steps",
        "9",     "--resolution", "32", "--preview", file("shown.png"), "--metrics", file("log.jsonl")};
    const ProgramResult run = run_neuvv(command);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(segments_logged(), (std::set<int>{0, 1}));
    EXPECT_EQ(media::read_png(file("shown.png")).width, 3 * 48u);
    EXPECT_NE(run.out.find("3 frames in 2 segments"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("000000.nvv: "), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("after 3 steps"), std::string::npos) << "a third of the frames: " << run.out;
    EXPECT_NE(run.out.find("after 6 steps"), std::string::npos) << run.out;
    EXPECT_EQ(voctree::read_nvv(show + "/000000.nvv").frames, 1u);
    EXPECT_EQ(voctree::read_nvv(show + "/000001.nvv").frames, 2u);
    EXPECT_FALSE(std::filesystem::exists(training::state_path(show + "/000001.nvv"))) << "it is finished";

    // A segment that is gone is trained again; the others stay.
    const std::string first = read_text(show + "/000000.nvv");
    std::filesystem::remove(show + "/000001.nvv");
    std::vector<std::string> resume = {"train",     file("data"),     "-o", show, "--resume", "--steps", "9",
                                       "--metrics", file("log.jsonl")};
    const ProgramResult again = run_neuvv(resume);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out.find("000000.nvv: "), std::string::npos) << again.out;
    EXPECT_EQ(voctree::read_nvv(show + "/000001.nvv").frames, 2u);
    EXPECT_EQ(read_text(show + "/000000.nvv"), first);
    EXPECT_EQ(segments_logged(), (std::set<int>{0, 1})) << "the lines of the other segment stay";
}

TEST_F(CliSegments, APartIsTrainedAgain) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const std::string show = file("show.nvv");
    std::vector<std::string> command = {"train", file("data"), "-o", show,           "--segment",
                                        "1",     "--steps",    "6",  "--resolution", "32"};
    ASSERT_EQ(run_neuvv(command).code, 0);
    std::vector<std::string> before;
    for (const char* name : {"/000000.nvv", "/000001.nvv", "/000002.nvv"}) before.push_back(read_text(show + name));
    expect_refused({"train", file("data"), "-o", show, "--from", "1", "--to", "2", "--steps", "9"}, 2, {"--overwrite"});
    EXPECT_EQ(read_text(show + "/000001.nvv"), before[1]);
    const ProgramResult run = run_neuvv({"train", file("data"), "-o", show, "--from", "1", "--to", "2", "--steps", "9",
                                         "--resolution", "32", "--overwrite"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.out.find("000001.nvv: "), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("after 9 steps"), std::string::npos) << "the budget is the part's: " << run.out;
    EXPECT_NE(run.out.find("1 frames in 1 segments"), std::string::npos) << run.out;
    EXPECT_EQ(read_text(show + "/000000.nvv"), before[0]);
    EXPECT_NE(read_text(show + "/000001.nvv"), before[1]);
    EXPECT_EQ(read_text(show + "/000002.nvv"), before[2]);
    const auto refuse = [&](std::vector<std::string> more, std::initializer_list<std::string> parts_of_error) {
        std::vector<std::string> words = {"train", file("data"), "--from", "1", "--overwrite"};
        words.insert(words.end(), more.begin(), more.end());
        expect_refused(words, 2, parts_of_error);
    };
    refuse({"-o", show}, {"show.nvv", "--minutes"});
    refuse({"-o", show, "--to", "4", "--steps", "1"}, {"--from", "3 frames"});
    refuse({"-o", scene, "--steps", "1"}, {"--from", "--segment"});
    refuse({"-o", show, "--segment", "2", "--steps", "1"}, {"--segment", "3 segments"});
    refuse({"-o", show, "--segment", "1", "--steps", "1", "--plan"}, {"--plan", "--from"});
    refuse({"-o", file("new.nvv"), "--segment", "1", "--steps", "1"}, {"--from", "--segment"});
    EXPECT_FALSE(std::filesystem::exists(file("new.nvv")));
    EXPECT_EQ(read_text(show + "/000000.nvv"), before[0]);
}

// What is there stays until the new clip is whole, also where that has other segments.
TEST_F(CliSegments, AClipIsReplacedOnceTheNewOneIsWhole) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const std::string show = file("show.nvv");
    write_segmented_copy(test::random_tree({.leaves = 200, .frames = 3}), {1, 2}, show);
    const std::string first = read_text(show + "/000000.nvv"), second = read_text(show + "/000001.nvv");
    std::vector<std::string> command = {"train", file("data"), "-o", show,           "--segment",
                                        "3",     "--steps",    "4",  "--resolution", "32"};
    const auto with = [&](const char* option) {
        std::vector<std::string> words = command;
        words.emplace_back(option);
        return words;
    };
    expect_refused(command, 2, {"show.nvv", "is there already", "--resume", "--overwrite"});
    expect_refused(with("--plan"), 2, {"is there already"});
    std::vector<std::string> cluster = {"cluster", "sbatch", "--dry-run", "--"};
    cluster.insert(cluster.end(), command.begin(), command.end());
    expect_refused(cluster, 2, {"is there already"});
    cluster.emplace_back("--overwrite");
    const ProgramResult planned = run_neuvv(cluster);
    ASSERT_EQ(planned.code, 0) << planned.err;
    EXPECT_EQ(read_text(show + "/job.sh").find("--overwrite"), std::string::npos)
        << "a task goes on with what was begun";
    EXPECT_EQ(read_text(show + "/000000.nvv"), first);
    EXPECT_EQ(read_text(show + "/000001.nvv"), second);
    EXPECT_EQ(voctree::read_clip_index(show).segments.size(), 2u);

    const ProgramResult trained = run_neuvv(with("--resume"));
    ASSERT_EQ(trained.code, 0) << trained.err;
    EXPECT_EQ(voctree::read_clip_index(show).segments.size(), 1u);
    EXPECT_NE(read_text(show + "/000000.nvv"), first);
    EXPECT_FALSE(std::filesystem::exists(show + "/000001.nvv"));
    EXPECT_FALSE(std::filesystem::exists(show + "/new.nvv"));
    EXPECT_TRUE(std::filesystem::exists(show + "/job.sh")) << "and the logs that Slurm still writes";
}

TEST_F(CliSegments, AFileIsReplacedOnceTheNewOneIsWhole) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const std::string before = read_text(scene);
    std::vector<std::string> command = {"train", file("data"), "-o", scene, "--resolution", "32"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), command.begin(), command.end());
        return more;
    };
    std::filesystem::copy_file(scene, file("scene.new.nvv"));  // of a user who likes that name
    std::filesystem::copy_file(scene, file("scene.new.nvv.state"));
    expect_refused(with({"--steps", "2"}), 2, {"scene.nvv", "is there already", "--resume", "--overwrite"});
    {
        std::vector<std::string> words = with({"--steps", "100000000", "--overwrite"});
        words.insert(words.begin(), NEUVV_PROGRAM);
        const test::ChildProcess killed(words, folder.path / "log");
        ASSERT_TRUE(killed.until([&] { return std::filesystem::exists(training::state_path(file(".scene.new.nvv"))); }))
            << read_text(folder.path / "log");
        expect_refused(with({"--steps", "2", "--overwrite"}), 2, {"is being trained by process"});
        killed.send(SIGKILL);
        ASSERT_TRUE(killed.until([&] { return killed.ended(); }));
    }
    EXPECT_EQ(read_text(scene), before);
    const ProgramResult resumed = run_neuvv(with({"--steps", "2", "--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_NE(resumed.out.find("is replaced by it"), std::string::npos) << resumed.out;
    EXPECT_NE(resumed.out.find("scene.nvv.state, "), std::string::npos) << resumed.out;
    EXPECT_NE(read_text(scene), before);
    for (const char* mine : {"scene.new.nvv", "scene.new.nvv.state"}) EXPECT_EQ(read_text(file(mine)), before);
    for (const char* rest : {".scene.new.nvv", ".scene.new.nvv.state"})
        EXPECT_FALSE(std::filesystem::exists(file(rest)));
    EXPECT_TRUE(std::filesystem::exists(training::state_path(scene))) << "a larger budget goes on from it";
}

// All segments see through the same corrected cameras, also those that are trained later.
TEST_F(CliSegments, CorrectionsOfTheRigAreFoundOnce) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const std::string show = file("show.nvv");
    std::vector<std::string> command = {"train",   file("data"), "-o",           show, "--segment", "1",
                                        "--steps", "6",          "--resolution", "32", "--refine",  "poses"};
    const ProgramResult run = run_neuvv(command);
    ASSERT_EQ(run.code, 0) << run.err;
    const auto correction = training::read_rig_correction(show);
    ASSERT_TRUE(correction);
    EXPECT_EQ(correction->cameras, (std::vector<std::string>{"c00", "c01"}));
    ASSERT_EQ(correction->changes.poses.size(), 2u);
    EXPECT_NE(correction->changes.poses[0], training::PoseChange{});
    EXPECT_TRUE(correction->changes.frames_late.empty());

    // Another correction in its place shows what a segment takes: cameras that look far past the performer.
    training::RigCorrection other = *correction;
    for (training::PoseChange& pose : other.changes.poses) pose = {0, 0.03, 0, 0, 0, 0, 0};
    training::write_rig_correction(show, other);
    const auto retrain = [&](const char* segment) {
        std::filesystem::remove(show + segment);
        const ProgramResult result = run_neuvv(
            {"train", file("data"), "-o", show, "--resume", "--steps", "6", "--resolution", "32", "--refine", "poses"});
        EXPECT_EQ(result.code, 0) << result.err;
        return result.out;
    };
    EXPECT_NE(retrain("/000001.nvv").find("turned by 1.72°"), std::string::npos);
    expect_refused({"train", file("data"), "-o", show, "--from", "1", "--steps", "6", "--refine", "auto"}, 2,
                   {"--refine", "all segments"});
    ASSERT_EQ(run_neuvv({"train", file("data"), "-o", show, "--segment", "1", "--steps", "3", "--resolution", "32",
                         "--overwrite"})
                  .code,
              0);
    EXPECT_FALSE(training::read_rig_correction(show)) << "the new clip corrects nothing";
}

// A performer who is not there yet, and an image that is damaged, cost their own segments alone.
TEST_F(CliSegments, OneSegmentDoesNotStopTheOthers) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    for (const char* name : {"c00_f0.png", "c01_f0.png"})
        media::write_png(folder.path / "data/test" / name, media::Image(48, 40));
    const std::string sound = read_text(folder.path / "data/test/c00_f1.png");
    write_text(folder.path / "data/test/c00_f1.png", "no image");
    const std::string show = file("show.nvv");
    std::vector<std::string> command = {"train", file("data"), "-o", show,           "--segment",
                                        "1",     "--steps",    "6",  "--resolution", "32"};
    const ProgramResult run = run_neuvv(command);
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_NE(run.err.find("1 of 3 segments could not be trained"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("c00_f1.png"), std::string::npos) << run.err;
    EXPECT_EQ(voctree::read_nvv(show + "/000000.nvv").leaf_count, 0u);
    EXPECT_FALSE(std::filesystem::exists(show + "/000001.nvv"));
    EXPECT_GT(voctree::read_nvv(show + "/000002.nvv").leaf_count, 0u);

    // A stage shows the segments that there are, and nothing at the times of the others.
    const std::string stage = file("show.gltf");
    test::write_stage(stage, show, "anna");
    const auto shown = [&](const char* time) {
        const ProgramResult result = run_neuvv(
            {"render", stage, "-o", file("a.png"), "--size", "32x32", "--orbit", "--time", time, "--overwrite"});
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_NE(result.err.find("000001.nvv"), std::string::npos) << "the missing segment is named: " << result.err;
        return media::read_png(file("a.png")).rgba;
    };
    const auto nobody = shown("0");
    EXPECT_EQ(shown("0.04"), nobody);
    EXPECT_NE(shown("0.08"), nobody);

    write_text(folder.path / "data/test/c00_f1.png", sound);
    command.emplace_back("--resume");
    const ProgramResult again = run_neuvv(command);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_GT(voctree::read_nvv(show + "/000001.nvv").leaf_count, 0u);
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

// Several processes that train one clip of three segments.
struct CliSharedTraining : CliSegments {
    std::string show = file("show.nvv");

    void SetUp() override {
        CliSegments::SetUp();
        write_own_data();
        std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    }
    std::vector<std::string> command(const char* steps, std::vector<std::string> more) const {
        std::vector<std::string> words = {"train", file("data"), "-o",  show,           "--segment",
                                          "1",     "--steps",    steps, "--resolution", "32"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    static std::vector<std::string> with_program(std::vector<std::string> words) {
        words.insert(words.begin(), NEUVV_PROGRAM);
        return words;
    }
    std::string segment(uint32_t frame) const { return show + "/" + voctree::segment_file_name(frame); }
    void expect_finished() const {
        for (const uint32_t frame : {0u, 1u, 2u}) {
            EXPECT_EQ(voctree::read_nvv(segment(frame)).frames, 1u);
            EXPECT_FALSE(std::filesystem::exists(training::state_path(segment(frame))));
            EXPECT_FALSE(training::claim_of(segment(frame)));
        }
        EXPECT_FALSE(training::claim_of(show));
    }
};

TEST_F(CliSharedTraining, ASecondProcessHelps) {
    ASSERT_EQ(run_neuvv(command("30", {"--plan"})).code, 0);
    EXPECT_EQ(voctree::read_clip_index(show).segments.size(), 3u);
    EXPECT_FALSE(std::filesystem::exists(segment(0)));
    const test::ChildProcess first(with_program(command("100000000", {"--resume"})), folder.path / "first");
    ASSERT_TRUE(first.until([&] { return std::filesystem::exists(segment(0)); })) << read_text(folder.path / "first");

    expect_refused(command("30", {}), 2, {"000000.nvv", "is being trained by process", "--resume"});
    const ProgramResult told = run_neuvv({"info", show, "--json"});
    const auto segments = nlohmann::json::parse(told.out).at("segments");
    EXPECT_NE(segments[0].at("training").at("owner").get<std::string>().find("process"), std::string::npos);
    EXPECT_FALSE(segments[1].contains("training"));

    const ProgramResult second = run_neuvv(command("30", {"--resume"}));
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_EQ(second.out.find("000000.nvv: "), std::string::npos) << second.out;
    EXPECT_NE(second.out.find("segment 1 of 3 is left to process"), std::string::npos) << second.out;
    EXPECT_FALSE(std::filesystem::exists(training::state_path(segment(1))));
    EXPECT_TRUE(std::filesystem::exists(segment(2)));

    // The first is killed; what it had trained goes on elsewhere.
    first.send(SIGKILL);
    ASSERT_TRUE(first.until([&] { return first.ended(); }));
    const ProgramResult third = run_neuvv(command("30", {"--resume"}));
    EXPECT_EQ(third.code, 0) << third.err;
    EXPECT_NE(third.out.find("3 frames in 3 segments"), std::string::npos) << third.out;
    expect_finished();
}

TEST_F(CliSharedTraining, AReplacementThatIsBeingTrainedStays) {
    ASSERT_EQ(run_neuvv(command("3", {})).code, 0);
    ASSERT_EQ(run_neuvv(command("3", {"--overwrite", "--plan"})).code, 0);
    const std::string place = show + "/new.nvv";
    const auto claim = training::RunClaim::take(place + "/" + voctree::segment_file_name(1));
    ASSERT_TRUE(claim);
    expect_refused(command("3", {"--overwrite"}), 2, {"new.nvv/000001.nvv", "is being trained by process"});
    EXPECT_EQ(voctree::read_clip_index(place).segments.size(), 3u);
}

// The second rank finds what the first has begun.
TEST_F(CliSharedTraining, ThePreviewIsOfTheFirstRank) {
    const std::vector<std::string> words = command("3", {"--preview", file("shown.png")});
    const std::string ranks = "OMPI_COMM_WORLD_SIZE=2 PMIX_NAMESPACE=77 OMPI_COMM_WORLD_RANK=";
    for (const char* rank : {"0", "1"}) {
        const ProgramResult result = run_neuvv(words, ranks + rank);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_TRUE(std::filesystem::exists(file("shown.png")));
    }
}

// On a full disk for instance. stdbuf: each line is written at once.
TEST_F(CliSharedTraining, AllIsTrainedWhereNobodyCanReadWhatItTells) {
    ASSERT_EQ(run_neuvv(command("3", {})).code, 0);
    const std::string before = read_text(segment(2));
    EXPECT_EQ(run_neuvv(command("6", {"--overwrite"}), "stdbuf -oL", ">/dev/full").code, 1);
    expect_finished();
    EXPECT_NE(read_text(segment(2)), before);
    EXPECT_FALSE(std::filesystem::exists(show + "/new.nvv"));
}

// The folder in the lock's place stands for a file system without locks.
TEST_F(CliSharedTraining, AFileIsReplacedWithoutALock) {
    std::filesystem::create_directory(file(".scene.new.nvv.replace"));
    const std::string before = read_text(scene);
    const ProgramResult result =
        run_neuvv({"train", file("data"), "-o", scene, "--resolution", "32", "--steps", "2", "--overwrite"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(read_text(scene), before);
}

TEST_F(CliSharedTraining, OneFileIsTrainedByOneProcess) {
    std::vector<std::string> words = {"train", file("data"), "-o", file("one.nvv"), "--steps", "100000000"};
    const test::ChildProcess first(with_program(words), folder.path / "first");
    ASSERT_TRUE(first.until([&] { return std::filesystem::exists(file("one.nvv")); }));
    expect_refused(words, 2, {"one.nvv", "is being trained by process"});
}

// Training by ranks of mpirun. Only these cases need Open MPI, without which the program works (support/mpirun.h).
struct CliMpiTraining : CliSharedTraining {
    void SetUp() override {
        CliSharedTraining::SetUp();
        if (!test::prepare_mpirun()) GTEST_SKIP() << "needs mpirun (package openmpi-bin)";
    }
};

// Whether a process is rank 0 of Open MPI, which alone tells of the whole run.
bool is_first_rank(int64_t process) {
    return read_text(fmt::format("/proc/{}/environ", process)).find("OMPI_COMM_WORLD_RANK=0") != std::string::npos;
}

// What mpirun starts: three ranks, one of which is killed.
TEST_F(CliMpiTraining, ARankIsKilled) {
    test::ChildProcess job(test::under_mpirun("3", with_program(command("1500", {})), {"--enable-recovery"}),
                           folder.path / "log");
    const auto log = [&] { return read_text(folder.path / "log"); };
    int64_t process = 0;
    uint32_t victim = 0;  // a segment that another rank than the first trains
    const auto can_be_killed = [&](uint32_t index) {
        const std::optional<training::ClaimState> claim = training::claim_of(segment(index));
        return claim && claim->fraction > 0 && std::filesystem::exists(training::state_path(segment(index))) &&
               std::sscanf(claim->owner.c_str(), "process %ld of", &process) == 1 && !is_first_rank(process);
    };
    ASSERT_TRUE(job.until([&] {
        for (victim = 0; victim < 3; ++victim)
            if (can_be_killed(victim)) return true;
        return false;
    })) << log();
    kill(static_cast<pid_t>(process), SIGKILL);
    job.wait();  // mpirun ends with the code of the rank that was killed
    EXPECT_NE(log().find("wrote " + show + ": 3 frames in 3 segments"), std::string::npos) << log();
    EXPECT_NE(log().find("wrote " + segment(victim) + ": "), std::string::npos) << "by another rank: " << log();
    expect_finished();
}

// Whether nobody trains into the file any more, at the latest in a minute: mpirun kills ranks that do not end within a
// second of its signal, and ends itself before the system has taken down what they had.
bool ends_soon(const std::filesystem::path& nvv) {
    const double start = seconds_now();
    while (training::claim_of(nvv)) {
        if (seconds_now() > start + 60) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
}

// Two ranks that train one tree, ended together in the middle.
TEST_F(CliMpiTraining, RanksShareOneTree) {
    const auto ranks = [&](const char* steps, const std::vector<std::string>& more) {
        std::vector<std::string> words =
            with_program({"train", file("data"), "-o", file("one.nvv"), "--steps", steps, "--resolution", "32"});
        words.insert(words.end(), more.begin(), more.end());
        return test::under_mpirun("2", words, {"--mca", "odls_base_sigkill_timeout", "3"});
    };
    const auto log = [&] { return read_text(folder.path / "log"); };
    {
        test::ChildProcess first(ranks("100000000", {}), folder.path / "log");
        ASSERT_TRUE(first.until([&] { return log().find("k rays/s") != std::string::npos; })) << log();
        first.send(SIGTERM);  // mpirun passes it on
        ASSERT_TRUE(first.until([&] { return first.ended(); }));
        EXPECT_NE(log().find("the first of 2 processes"), std::string::npos) << log();
    }
    ASSERT_TRUE(ends_soon(file("one.nvv"))) << log();
    const uint64_t reached = training::load_checkpoint(file("one.nvv")).run.step;
    const std::string whole = std::to_string(reached + 20);
    test::ChildProcess second(ranks(whole.c_str(), {"--resume"}), folder.path / "log");
    EXPECT_EQ(second.wait(), 0) << log();
    EXPECT_EQ(training::load_checkpoint(file("one.nvv")).run.step, reached + 20);
    EXPECT_EQ(voctree::read_nvv(file("one.nvv")).frames, 3u);
    ASSERT_NE(log().find("wrote "), std::string::npos) << log();
    EXPECT_EQ(log().find("wrote "), log().rfind("wrote ")) << "one rank says it: " << log();
}

TEST_F(CliSegments, WrongRunsAreRefused) {
    const std::string before = read_text(parts + "/000000.nvv");
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const auto refuse = [&](std::vector<std::string> more, std::initializer_list<std::string> parts_of_error) {
        std::vector<std::string> words = {"train", file("data"), "--steps", "1"};
        words.insert(words.end(), more.begin(), more.end());
        expect_refused(words, 2, parts_of_error);
    };
    refuse({"-o", parts, "--resume", "--segment", "1"}, {"parts.nvv"});
    refuse({"-o", file("a.nvv"), "--segment", "none"}, {"--segment", "none"});
    refuse({"-o", file("a.nvv"), "--segment", "0"}, {"--segment", "at least one frame"});
    refuse({"-o", file("a.nvv"), "--segment", "1s"}, {"--segment", "frame rate"});
    refuse({"-o", scene, "--segment", "2"}, {"scene.nvv", "no segmented clip"});
    refuse({"-o", parts}, {"parts.nvv", "--segment"});
    refuse({"-o", parts, "--resume"}, {"parts.nvv", "4 frames", "3"});
    refuse({"-o", file("a.nvv"), "--plan"}, {"--plan", "--segment"});
    const ProgramResult alone = run_neuvv({"train", file("data"), "-o", file("alone.nvv"), "--steps", "1"},
                                          "OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=2");
    EXPECT_EQ(alone.code, 2);
    EXPECT_NE(alone.err.find("libmpi.so.40"), std::string::npos) << "there is only one process: " << alone.err;
    expect_refused({"train", file("data"), "-o", parts, "--resume"}, 2, {"--resume", "--minutes"});
    EXPECT_EQ(read_text(parts + "/000000.nvv"), before) << "nothing was removed";
}

}  // namespace
}  // namespace neuvv
