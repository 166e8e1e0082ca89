// Training of clips in segments, on the command line.
#include <gtest/gtest.h>

#include <set>

#include "render/clips/stage_renderer.h"
#include "support/child_process.h"
#include "support/mpirun.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_segments.h"
#include "training/rig/rig_file.h"
#include "training/run/checkpoint.h"
#include "voctree/files/clip.h"

namespace neuvv {
namespace {

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
