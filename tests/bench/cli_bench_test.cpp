// neuvv-bench: that each measurement runs, prints what it promises, and refuses what it cannot do.
#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/body_tree.h"
#include "support/segmented_copy.h"
#include "tests/tools/cli_gpu.h"
#include "tests/tools/trace_spans.h"

namespace neuvv {
namespace {

// Expects that the table of a measurement contains these words.
void expect_words(const std::vector<std::string>& command, std::initializer_list<const char*> words) {
    const ProgramResult table = run_neuvv(command);
    EXPECT_EQ(table.code, 0) << table.err;
    for (const char* word : words) EXPECT_NE(table.out.find(word), std::string::npos) << word << " in\n" << table.out;
}

nlohmann::json json_of(std::vector<std::string> command, const std::vector<std::string>& more = {}) {
    command.insert(command.end(), more.begin(), more.end());
    command.push_back("--json");
    const ProgramResult result = run_neuvv(command);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
}

TEST(Bench, EveryVerbHelpsWithExamples) {
    const std::string overview = run_neuvv({"--help"}).out;
    for (const char* verb : {"open", "render", "walk", "slice", "stream", "stereo", "instances", "far", "stage", "play",
                             "xr", "train", "team", "edit", "coach"}) {
        EXPECT_NE(overview.find(verb), std::string::npos) << verb;
        const ProgramResult result = run_neuvv({verb, "--help"});
        EXPECT_EQ(result.code, 0) << verb;
        const size_t examples = result.out.find("Examples");
        ASSERT_NE(examples, std::string::npos) << verb;
        EXPECT_NE(result.out.find(std::string("neuvv-bench ") + verb, examples), std::string::npos) << verb;
    }
    const ProgramResult alone = run_neuvv({});
    EXPECT_EQ(alone.code, 0);
    EXPECT_NE(alone.out.find("stereo"), std::string::npos) << "the verbs";
    expect_refused({"sing"}, 2, {"sing", "stereo"});
}

TEST(Bench, EditMeasuresDragsAndTheirHistory) {
    const nlohmann::json json = json_of({"edit", "--megabytes", "1", "--steps", "10"});
    EXPECT_GT(json["large"]["stage_bytes"], 1000000);
    EXPECT_GT(json["large"]["median_ms"], 0.0);
    EXPECT_GE(json["large"]["worst_ms"], json["large"]["median_ms"]);
    EXPECT_GT(json["empty"]["history_bytes"], 0);
    EXPECT_LT(json["large"]["history_bytes"], 100000) << "the buffers are not in it";
    EXPECT_NE(run_neuvv({"edit", "--megabytes", "0.1", "--steps", "2"}).out.find("times as long"), std::string::npos);
    expect_refused({"edit", "--megabytes", "100"}, 2, {"--megabytes"});
}

TEST_F(CliGpu, BenchTrainComparesWithDirectGradients) {
    write_own_data();
    std::filesystem::copy_file(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json",
                               std::filesystem::copy_options::overwrite_existing);
    for (const char* repeats : {"1", "6"}) {  // one step alone has no pass "slice"
        const ProgramResult result = run_neuvv({"train", scene, file("data"), "--repeats", repeats, "--tiles", "2"});
        ASSERT_EQ(result.code, 0) << result.err;
        for (const char* word : {"trace adjoint", "direct adjoint", "times as fast as direct", "rays/s", "GB/s"})
            EXPECT_NE(result.out.find(word), std::string::npos) << word << " in\n" << result.out;
    }
    const nlohmann::json json = json_of({"train", scene, file("data"), "--repeats", "2", "--tiles", "2"});
    EXPECT_GT(json["mrays_per_second"], 0.0);
    EXPECT_GT(json["copy_gb_s"], 0.0);
    EXPECT_GT(json["optimiser_gb_s"], 0.0);
    EXPECT_TRUE(json["passes_ms"].contains("trace adjoint")) << json;
    expect_refused({"train", scene, file("data"), "--repeats", "0"}, 2, {"--repeats"});
}

TEST_F(CliGpu, BenchTeamPredictsStepsOfSeveralProcesses) {
    write_own_data();
    std::filesystem::copy_file(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json",
                               std::filesystem::copy_options::overwrite_existing);
    const std::vector<std::string> command{"team",    scene, file("data"), "--members", "2,3",
                                           "--tiles", "2",   "--repeats",  "1"};
    const nlohmann::json steps = json_of(command)["steps"];
    ASSERT_EQ(steps.size(), 3u);
    EXPECT_EQ(steps[0]["members"], 1);
    EXPECT_EQ(steps[0]["times_one"], 1.0);
    for (const nlohmann::json& step : {steps[1], steps[2]}) {
        EXPECT_GT(step["rays"], steps[0]["rays"]);
        EXPECT_GE(step["touched_by_all"], step["touched"]);
        EXPECT_LE(step["touched_by_all"], step["touched"].get<double>() * step["members"].get<double>());
        EXPECT_GT(step["received_mb"], 0.0);
        EXPECT_GT(step["network_ms"], 0.0);
        EXPECT_GT(step["times_one"], 0.0);
    }
    expect_words(command, {"members", "times one"});
    expect_refused({"team", scene, file("data"), "--members", "1"}, 2, {"--members"});
}

TEST_F(CliGpu, BenchRenderComparesWithThePaper) {
    const std::vector<std::string> command = {"render", scene, "--size", "64x48", "--views", "2", "--repeats", "1"};
    expect_words(command, {"the paper's", "shaded", "playing", "Mrays/s", "C++", "PSNR", "% of the pixels covered"});
    const nlohmann::json json = json_of(command);
    EXPECT_GT(json["covered"], 0.02);
    EXPECT_GT(json["ways"]["paper"]["rest_ms"], 0.0);
    EXPECT_GT(json["ways"]["shaded"]["slice_ms"], 0.0);
    EXPECT_GT(json["host_rays_ms"], 0.0);
    EXPECT_GT(json["bytes_a_ray"], 40.0 + 20.0 * json["nodes_a_ray"].get<double>());
    EXPECT_LT(json["mean_difference_of_255"], 1.0);
    EXPECT_LT(json["host_difference"], 0.01);
    expect_refused({"render", scene, "--size", "0x9"}, 2, {"--size"});
    expect_refused({"render", scene, "--views", "0"}, 2, {"--views"});
    expect_refused({"render", file("none.nvv")}, 2, {"none.nvv"});
}

// The latency is as long as the device's time, and the 99th percentile at least the median.
void expect_frame_times(const nlohmann::json& json) {
    for (const char* time : {"cpu_ms", "gpu_ms", "latency_ms"}) {
        EXPECT_GT(json[time]["p50"], 0.0) << time;
        EXPECT_GE(json[time]["p99"], json[time]["p50"]) << time;
    }
    EXPECT_GE(json["latency_ms"]["p50"], json["gpu_ms"]["p50"]);
}

TEST_F(CliGpu, BenchXrMeasuresLatency) {
    const std::vector<std::string> command = {"xr", scene, "--size", "64x64", "--frames", "4"};
    expect_words(command, {"CPU ms a frame", "GPU ms a frame", "latency", "p99"});
    expect_frame_times(json_of(command));
    expect_refused({"xr", scene, "--frames", "0"}, 2, {"--frames"});
}

// In turns: each frame is waited for, or the next is recorded before.
TEST_F(CliGpu, BenchXrRecordsFramesAhead) {
    const ProgramResult result =
        run_neuvv({"xr", scene, "--size", "64x64", "--frames", "1", "--trace", file("trace.json")});
    ASSERT_EQ(result.code, 0) << result.err;
    const size_t ahead = frames_recorded_ahead(file("trace.json"));
    EXPECT_GE(ahead, 5u * 23) << "all but the first of five rounds of 24";
    EXPECT_LE(ahead, 5u * 24) << "where each is waited for";
}

TEST_F(CliGpu, BenchPlayCountsFramesAndSeeks) {
    write_segmented_copy(tree, {1, 1, 2}, file("parts.nvv"));
    const std::vector<std::string> command = {"play", file("parts.nvv"), "--size", "64x48", "--seconds",
                                              "1",    "--seek-every",    "0.25"};
    expect_words(command, {"were missed", "was held", "after a seek", "in the second", "CPU ms a frame",
                           "GPU ms a frame", "latency"});
    const nlohmann::json json = json_of(command);
    expect_frame_times(json);
    EXPECT_GT(json["images"], 3);
    EXPECT_GT(json["frames"], 0);
    EXPECT_GT(json["seek_ms"], 0.0);
    EXPECT_GT(json["late_bytes"], 0);
    expect_refused({"play", file("parts.nvv"), "--seconds", "0"}, 2, {"--seconds"});
}

TEST_F(CliGpu, BenchStreamMeasuresBothWays) {
    const std::string stream = NEUVV_SOURCE_DIR "/tests/stream/vectors/usual.nvs";
    expect_words({"stream", stream}, {"bytes to slice", "slice to device", "by weights", "of the device"});
    const nlohmann::json json = json_of({"stream", stream, "--frames", "2"});
    EXPECT_GT(json["leaves"], 0);
    EXPECT_GE(json["straight_ms"], std::min(json["upload_ms"].get<double>(), json["upload_raw_ms"].get<double>()));
    EXPECT_GT(json["upload_raw_ms"], 0.0);
    EXPECT_GE(json["by_tree_ms"], json["slice_ms"]);
    EXPECT_GT(json["device_bytes"], 0);
    expect_refused({"stream", scene}, 2, {"is no stream", "publish"});
}

TEST_F(CliGpu, BenchFarComparesLevels) {
    const std::vector<std::string> command = {"far", scene,     "--size", "48x48",     "--views",
                                              "1",   "--count", "4",      "--repeats", "1"};
    expect_words(command, {"PSNR", "flicker", "a step with a switch", "4 performers", "upload"});
    const nlohmann::json json = json_of(command);
    ASSERT_EQ(json["footprints"].size(), 4u);
    EXPECT_GE(json["footprints"][3]["level"], json["footprints"][0]["level"]);
    EXPECT_GT(json["footprints"][0]["psnr"][0], 5.0);
    EXPECT_GE(json["bytes"][1], json["bytes"][0]);
    expect_refused({"far", scene, "--count", "0"}, 2, {"--count"});
}

TEST_F(CliGpu, BenchRenderHasARivalWhereItIsAskedFor) {
    std::vector<std::string> command = {"render", scene, "--size", "64x48", "--views", "2", "--repeats", "1"};
    EXPECT_EQ(run_neuvv(command).out.find("rival"), std::string::npos);
    command.insert(command.end(), {"--rival", "raster"});
    expect_words(command, {"rival: sparse voxels rasterised", "project", "sort", "composite", "pairs"});
    const nlohmann::json rival = json_of(command)["rival"];
    for (const char* pass : {"project", "sort", "composite"}) EXPECT_GT(rival["passes_ms"][pass], 0.0) << pass;
    EXPECT_GT(rival["pairs"], 10.0);
    EXPECT_GT(rival["psnr_db"], 60.0) << "the same samples make the same image";
    EXPECT_LT(rival["mean_difference_of_255"], 0.01);
    expect_refused({"render", scene, "--rival", "splats"}, 2, {"--rival"});
}

TEST_F(CliGpu, BenchOpenShowsTheCoarseTreeFirst) {
    const std::string large = file("large.nvv");
    const ProgramResult result =
        run_neuvv({"open", large, "--synthetic", "32", "--size", "64x48", "--json", "--images", file("images")});
    ASSERT_EQ(result.code, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_NEAR(json["bytes"], 32e6, 3e6);
    EXPECT_GT(json["first"]["leaves"], 500);
    EXPECT_GE(json["whole"]["leaves"], 32 * json["first"]["leaves"].get<uint32_t>());
    EXPECT_GT(json["first"]["total_s"], 0.0);
    EXPECT_LT(json["first"]["read_s"], json["whole"]["read_s"]);
    EXPECT_GT(json["psnr_db"], 12.0);
    EXPECT_LT(json["psnr_db"], 99.0);
    EXPECT_EQ(media::read_png(file("images/coarse.png")).width, 64u);
    EXPECT_EQ(media::read_png(file("images/whole.png")).height, 48u);
    EXPECT_EQ(voctree::summarise_nvv(large).chunks[1].name, "hEAD");
    const ProgramResult again = run_neuvv({"open", large, "--size", "64x48"});
    for (const char* word : {"coarse tree", "whole tree", "upload", "% of the time"})
        EXPECT_NE(again.out.find(word), std::string::npos) << again.out;

    expect_refused({"open", large, "--images", file("images")}, 2, {"coarse.png", "is there already", "--overwrite"});
    expect_refused({"open", large, "--synthetic", "32"}, 2, {"large.nvv", "is there already"});
    EXPECT_NE(run_neuvv({"open", scene, "--size", "64x48"}).out.find("no coarse tree"), std::string::npos);
    expect_refused({"open", file("none.nvv")}, 2, {"none.nvv"});
}

TEST_F(CliGpu, BenchSliceTimesEachPass) {
    const ProgramResult table = run_neuvv({"slice", scene, "--frames", "1", "--repeats", "1"});
    ASSERT_EQ(table.code, 0) << table.err;
    for (const char* word : {"density", "nodes", "entries", "slots", "GB/s", "live in a frame"})
        EXPECT_NE(table.out.find(word), std::string::npos) << word << " in\n" << table.out;
    const nlohmann::json json = nlohmann::json::parse(run_neuvv({"slice", scene, "--frames", "3", "--json"}).out);
    EXPECT_GT(json["live_leaves"], 1.0);
    EXPECT_LE(json["live_leaves"], json["leaves"]);
    EXPECT_GT(json["slice_ms"], 0.0);
    EXPECT_GT(json["copy_gb_s"], 0.0);
    expect_refused({"slice", scene, "--frames", "0"}, 2, {"--frames"});
}

TEST_F(CliGpu, BenchInstancesHoldsTimeAndMemoryAgainstOne) {
    const std::vector<std::string> command = {"instances", scene, "--size", "96x64", "--count", "5", "--repeats", "1"};
    expect_words(command, {"instances", "covered rays", "with a slice", "time grows", "memory is"});
    const nlohmann::json json = json_of(command, {"--slice-budget", "0"});
    EXPECT_EQ(json["all"]["with_a_slice"], 0);
    EXPECT_GT(json["all"]["covered_rays"], 3 * json["one"]["covered_rays"].get<int>());
    EXPECT_EQ(json["memory_ratio"], 1.0);
    expect_refused({"instances", scene, "--count", "1"}, 2, {"--count"});
    expect_refused({"instances", scene, "--slice-budget", "-1"}, 2, {"--slice-budget"});
}

TEST_F(CliGpu, BenchWalkTimesEachStep) {
    const std::vector<std::string> command = {"walk", scene, "--size", "64x48", "--views", "1", "--repeats", "1"};
    expect_words(command, {"from the root to every cell", "masks in registers", "one step", "grid", "bounds"});
    const nlohmann::json json = json_of(command);
    for (const char* step : {"restart", "node", "coalesce", "grid", "ranges"}) EXPECT_GT(json["trace_ms"][step], 0.0);
    expect_refused({"walk", scene, "--views", "0"}, 2, {"--views"});
}

TEST_F(CliGpu, BenchStereoDrawsBothEyes) {
    const std::vector<std::string> command = {"stereo", scene, "--size", "64x72", "--repeats", "2"};
    expect_words(command, {"both eyes", "one eye after the other", "same", "Mrays/s per TB/s", "passes of both eyes"});
    const nlohmann::json json = json_of(command);
    EXPECT_GT(json["covered"], 0.02);
    EXPECT_EQ(json["ways"]["stereo"]["rays"], 2 * 64 * 72);
    EXPECT_GT(json["ways"]["half"]["passes_ms"]["upscale"], 0.0);
    EXPECT_LT(json["ways"]["foveated"]["rays"], 0.5 * 2 * 64 * 72);
    EXPECT_GT(json["ways"]["half"]["psnr_db"], 15.0);
    EXPECT_LT(json["ways"]["half"]["psnr_db"], 60.0);
    expect_refused({"stereo", scene, "--size", "64"}, 2, {"--size"});
}

TEST_F(CliGpu, BenchStageComparesLightsAndCopies) {
    const std::vector<std::string> command = {"stage", scene, "--size", "64x48", "--repeats", "1", "--copies", "5"};
    expect_words(command, {"plain", "shadows and falloff", "paper", "5 copies", "times those of one"});
    const nlohmann::json json = json_of(command, {"--together", "--image", file("stage.png")});
    ASSERT_EQ(json["ways"].size(), 5u);
    for (const nlohmann::json& way : json["ways"]) EXPECT_GT(way["ms"], 0.0) << way["name"];
    EXPECT_GT(json["one_bytes"], 10000);
    EXPECT_EQ(media::read_png(file("stage.png")).width, 64u);
    for (const char* verb : {"stage", "instances"}) {
        expect_refused({verb, scene, "--image", file("stage.png")}, 2,
                       {"stage.png", "is there already", "--overwrite"});
        expect_refused({verb, scene, "--image", file("stage.jpg")}, 2, {"stage.jpg", ".png"});
    }
    EXPECT_EQ(run_neuvv({"instances", scene, "--size", "32x24", "--count", "2", "--repeats", "1", "--image",
                         file("stage.png"), "--overwrite"})
                  .code,
              0);
    EXPECT_EQ(media::read_png(file("stage.png")).width, 32u);
    expect_refused({"stage", scene, "--copies", "0"}, 2, {"--copies"});
    expect_refused({"stage", file("none.nvv")}, 2, {"none.nvv"});
}

TEST_F(CliGpu, BenchCoachTimesEachStepFromThePacketToTheRedLimb) {
    const motion::SkeletonClip dancer = test::performer_motion(75);
    voctree::write_nvv(scene, test::body_tree(dancer, 25, 25));
    const std::vector<std::string> command = {"coach", scene, "--size", "64x48", "--frames", "24"};
    expect_refused(command, 2, {"no performer with a skeleton"});
    motion::write_skeleton(file("scene.skeleton.glb"), dancer);
    expect_words(command, {"read a packet", "update the coach", "filter and compare", "choose the view",
                           "ghost and arrows", "without highlight", "a frame with it", "bind bones", "tint",
                           "added beside the render", "at most 20 ms"});
    const nlohmann::json mirrored = json_of(command, {"--packets", "500"});
    EXPECT_EQ(mirrored["frames"], 24);
    EXPECT_GT(mirrored["red_frames"], 5);
    for (const char* step : {"packet_ms", "update_ms", "compare_ms", "view_ms", "show_ms", "plain_ms", "red_ms"})
        EXPECT_GT(mirrored[step], 0.0) << step;
    EXPECT_GE(mirrored["added_p99_ms"], mirrored["added_ms"]);
    EXPECT_EQ(mirrored["packets"], 500);
    EXPECT_LT(mirrored["heap_late_bytes"].get<double>() - mirrored["heap_early_bytes"].get<double>(), 1e6);
    // The trainer's own motion arrives as it was sent: nothing is red.
    EXPECT_EQ(json_of(command, {"--against", file("scene.skeleton.glb")})["red_frames"], 0);
    expect_refused({"coach", scene, "--packets", "3"}, 2, {"--packets"});
    expect_refused({"coach", scene, "--against", file("none.bvh")}, 2, {"none.bvh"});
    expect_refused({"coach", scene, "--performer", "nobody"}, 2, {"nobody"});
}

}  // namespace
}  // namespace neuvv
