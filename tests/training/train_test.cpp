// Whole runs on a capture of a moving sphere, and what runs leave behind that are killed.
#include "training/run/train.h"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "base/error.h"
#include "support/child_process.h"
#include "support/edit_image.h"
#include "support/gpu_test.h"
#include "support/sphere_renders.h"
#include "training/capture/backdrop.h"
#include "training/run/checkpoint.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

training::TrainSettings small_run(uint64_t steps) {
    training::TrainSettings settings;
    settings.steps = steps;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 128;
    return settings;
}

bool go_on(const training::TrainProgress&) {
    return true;
}

using TrainTest = GpuTest;

TEST_F(TrainTest, CamerasThatItNeverSawSeeTheSphere) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    const training::TrainProgress last = training::train(device(), trained_sphere(), small_run(150), nvv, go_on);
    EXPECT_EQ(last.step, 150u);
    EXPECT_EQ(last.fraction, 1);
    EXPECT_GT(last.leaves, 100u);
    EXPECT_EQ(last.depth, 7u);  // one level finer than a pixel where the opacity sensitivity is high
    const std::vector<media::Image> truths = held_out_truths(kTrainedSphere);
    EXPECT_GT(mean_psnr(truths, held_out_renders(device(), kTrainedSphere, nvv)), 32);  // 40.8 measured
    EXPECT_EQ(folder.entries(), 2u);

    // The comparison can fail: it does with the sphere at a wrong time.
    std::vector<media::Image> shifted(truths.begin() + 1, truths.end());
    shifted.push_back(truths[0]);
    EXPECT_LT(mean_psnr(truths, shifted), 25);
}

// Walls at 2 to 9 m from the cameras, which look inwards; no image has a matte.
TEST_F(TrainTest, CamerasThatItNeverSawSeeTheRoom) {
    const TemporaryFolder folder;
    const training::Backdrop room{glm::dvec3(-4), glm::dvec3(4), 2.0};
    training::Dataset dataset = sphere_dataset({.cameras = 72, .frames = 1});
    for (training::View& view : dataset.views)
        view.image.store(training::clean_plate(room, dataset.cameras[view.camera]));
    training::TrainSettings settings = small_run(120);
    settings.shape = {.resolution = 24, .bases = 1, .hh_degree = 0};
    settings.surroundings = true;
    const std::filesystem::path nvv = folder.path / "room.nvv";
    // Interrupted among the phases that halve leaves.
    training::train(device(), dataset, settings, nvv,
                    [](const training::TrainProgress& now) { return now.fraction < 0.1; });
    EXPECT_GT(training::load_checkpoint(nvv).run.leaf_pixels, 0);
    settings.resume = true;
    EXPECT_EQ(training::train(device(), dataset, settings, nvv, go_on).step, 120u);
    const SphereCapture between{.cameras = 72, .frames = 1, .first_angle = 0.1 + std::numbers::pi / 72};
    std::vector<media::Image> truths;
    for (const uint32_t camera : {1u, 6u})
        truths.push_back(training::clean_plate(room, sphere_camera(between, camera)));
    const double psnr = mean_psnr(truths, held_out_renders(device(), between, nvv));
    RecordProperty("psnr", std::to_string(psnr));
    EXPECT_GT(psnr, 20);  // 22.3 measured
    EXPECT_LT(mean_psnr(truths, {truths[1], truths[0]}), 17) << "the comparison can fail";
}

// Moments, batches, phases and use go on from where they were, so the two runs differ only as two runs of one seed do.
TEST_F(TrainTest, AnInterruptedRunEndsAsAWholeOne) {
    const TemporaryFolder folder;
    const std::filesystem::path whole = folder.path / "whole.nvv", parts = folder.path / "parts.nvv";
    training::TrainSettings settings = small_run(240);
    training::train(device(), trained_sphere(), settings, whole, go_on);
    std::vector<uint64_t> ends;
    do {
        bool first = true;
        const training::TrainProgress last =
            training::train(device(), trained_sphere(), settings, parts, [&](const training::TrainProgress& now) {
                const bool goes_on = !first || now.step >= 200;
                first = false;
                return goes_on;
            });
        ends.push_back(last.step);
        settings.resume = true;
    } while (ends.back() < 240 && ends.size() < 100);
    EXPECT_EQ(ends.back(), 240u);
    EXPECT_GT(ends.size(), 1u) << "never interrupted";
    const std::vector<media::Image> truths = held_out_truths(kTrainedSphere);
    EXPECT_NEAR(mean_psnr(truths, held_out_renders(device(), kTrainedSphere, parts)),
                mean_psnr(truths, held_out_renders(device(), kTrainedSphere, whole)), 0.5);
    EXPECT_GT(
        mean_psnr(held_out_renders(device(), kTrainedSphere, whole), held_out_renders(device(), kTrainedSphere, parts)),
        40);
}

// Leaves numbers on the stack where the next call's variables will lie, so that reading one before it is made shows.
[[gnu::noinline]] void scribble_on_the_stack() {
    std::array<unsigned char, 1 << 16> scribble;
    scribble.fill(0x5a);
    asm volatile("" : : "r"(scribble.data()) : "memory");
}

TEST_F(TrainTest, AFinishedFileIsNoLargerThanAsked) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv", small = folder.path / "small.nvv";
    training::TrainSettings settings = small_run(60);
    training::train(device(), trained_sphere(), settings, nvv, go_on);
    settings.max_bytes = std::filesystem::file_size(nvv) / 2;
    scribble_on_the_stack();
    training::train(device(), trained_sphere(), settings, small, go_on);
    EXPECT_LE(std::filesystem::file_size(small), settings.max_bytes);
    EXPECT_GT(std::filesystem::file_size(small), settings.max_bytes / 2);
    EXPECT_GT(mean_psnr(held_out_truths(kTrainedSphere), held_out_renders(device(), kTrainedSphere, small)), 25);
}

TEST_F(TrainTest, ATreeNeverHasMoreLeavesThanAsked) {
    const TemporaryFolder folder;
    training::TrainSettings settings = small_run(60);
    settings.max_leaves = 1500;
    uint32_t max_leaves = 0;
    const auto count = [&](const training::TrainProgress& now) {
        max_leaves = std::max(max_leaves, now.leaves);
        return true;
    };
    training::train(device(), trained_sphere(), settings, folder.path / "sphere.nvv", count);
    // Reports come by the clock, and the file has no leaves that are always empty: the checkpoint has the run's tree.
    max_leaves = std::max(max_leaves, training::load_checkpoint(folder.path / "sphere.nvv").tree.leaf_count);
    EXPECT_LE(max_leaves, 1500u);
    EXPECT_GT(max_leaves, 500u);
}

TEST_F(TrainTest, UniformLeavesStayOfOneSize) {
    const TemporaryFolder folder;
    training::TrainSettings settings = small_run(60);
    settings.adaptive = false;
    training::train(device(), trained_sphere(), settings, folder.path / "sphere.nvv", go_on);
    const voctree::VOctree tree = voctree::read_nvv(folder.path / "sphere.nvv");
    for (const voctree::LeafPosition& position : voctree::leaf_positions(tree)) ASSERT_EQ(position.depth, 6u);
}

// Where a budget in minutes leaves few rays to each leaf, leaves stay twice as large, unless the user chose a
// resolution.
TEST_F(TrainTest, AShortRunHasLargerLeaves) {
    const auto depth_of = [&](double minutes, uint64_t steps, uint32_t resolution) {
        const TemporaryFolder folder;
        training::TrainSettings settings = small_run(steps);
        settings.minutes = minutes;
        settings.shape.resolution = resolution;
        settings.tiles_per_step = 1;  // few rays, however fast the device is
        const training::TrainProgress last =
            training::train(device(), trained_sphere(), settings, folder.path / "sphere.nvv", go_on);
        EXPECT_EQ(last.fraction, 1);
        return training::load_checkpoint(folder.path / "sphere.nvv").run.max_depth;
    };
    const uint32_t natural = depth_of(0, 60, 0);
    EXPECT_EQ(depth_of(0.02, 0, 0), natural - 1);
    EXPECT_EQ(depth_of(0.02, 0, 1u << natural), natural);
}

TEST_F(TrainTest, PartsCanBeLeftOut) {
    const auto leaves_without = [&](training::OptionalParts parts) {
        const TemporaryFolder folder;
        training::TrainSettings settings = small_run(120);
        settings.left_out = parts;
        training::train(device(), trained_sphere(), settings, folder.path / "sphere.nvv", go_on);
        EXPECT_EQ(training::load_checkpoint(folder.path / "sphere.nvv").run.left_out, parts);
        return voctree::read_nvv(folder.path / "sphere.nvv").leaf_count;
    };
    const auto bit = [](training::OptionalPart part) { return 1u << static_cast<uint32_t>(part); };
    const uint32_t all = leaves_without(0);
    EXPECT_GT(leaves_without(bit(training::OptionalPart::kMerge)), all);
    EXPECT_LT(leaves_without(bit(training::OptionalPart::kDivide)), all);
}

TEST_F(TrainTest, TheSameSeedGivesNearlyTheSameRun) {
    const TemporaryFolder folder;
    std::vector<std::vector<media::Image>> renders;
    for (const uint64_t seed : {1, 1, 2}) {
        const std::filesystem::path nvv = folder.path / (std::to_string(renders.size()) + ".nvv");
        training::TrainSettings settings = small_run(25);
        settings.seed = seed;
        training::train(device(), trained_sphere(), settings, nvv, go_on);
        renders.push_back(held_out_renders(device(), kTrainedSphere, nvv));
    }
    const double same = mean_psnr(renders[0], renders[1]), other = mean_psnr(renders[0], renders[2]);
    EXPECT_GT(same, 40);
    EXPECT_GT(same, other + 3);
}

TEST_F(TrainTest, ACallbackStopsTheRunAfterACheckpoint) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    uint32_t calls = 0;
    const training::TrainProgress last =
        training::train(device(), trained_sphere(), small_run(10000000), nvv, [&](const training::TrainProgress& now) {
            EXPECT_TRUE(std::filesystem::exists(nvv));
            EXPECT_GT(now.rays_per_s, 0);
            EXPECT_GT(now.eta_s, 0);
            ++calls;
            return false;
        });
    EXPECT_EQ(calls, 2u);  // the call that stopped the run, and the one at the end
    EXPECT_GT(last.step, 0u);
    EXPECT_LT(last.fraction, 1);
    EXPECT_EQ(training::load_checkpoint(nvv).run.step, last.step);
    EXPECT_EQ(voctree::read_nvv(nvv).leaf_count, last.leaves);
}

TEST_F(TrainTest, AResumedRunGoesOnAndImproves) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    training::train(device(), trained_sphere(), small_run(8), nvv, go_on);
    const std::vector<media::Image> truths = held_out_truths(kTrainedSphere);
    const double before = mean_psnr(truths, held_out_renders(device(), kTrainedSphere, nvv));
    training::TrainSettings settings = small_run(70);
    settings.resume = true;
    settings.shape.hh_degree = 3;  // a resumed run keeps its shape, losses and batches, whatever the settings are
    settings.weights.grad = 50;
    settings.tiles_per_step = 1;
    std::vector<media::Image> seen_in_callback;
    const training::TrainProgress last =
        training::train(device(), trained_sphere(), settings, nvv, [&](const training::TrainProgress& now) {
            EXPECT_EQ(now.began_at_step, 8u);
            seen_in_callback = held_out_renders(device(), kTrainedSphere, *now.field);
            return true;
        });
    EXPECT_EQ(last.step, 70u);
    EXPECT_EQ(last.field, nullptr);
    EXPECT_GT(last.epochs, 0);
    // The last call came after the last step, so its field is that of the file up to rounding to half precision.
    EXPECT_GT(mean_psnr(held_out_renders(device(), kTrainedSphere, nvv), seen_in_callback), 50);
    EXPECT_EQ(voctree::read_nvv(nvv).hh_degree, 1u);
    const training::RunState run = training::load_checkpoint(nvv).run;
    EXPECT_EQ(run.step, 70u);
    EXPECT_EQ(run.weights.grad, training::TrainSettings().weights.grad);
    EXPECT_EQ(run.tiles_per_step, small_run(8).tiles_per_step);
    EXPECT_GT(mean_psnr(truths, held_out_renders(device(), kTrainedSphere, nvv)), before + 1);
}

TEST_F(TrainTest, AnotherDataSetIsRefused) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    training::train(device(), trained_sphere(), small_run(2), nvv, go_on);
    training::Dataset other = trained_sphere();
    for (training::View& view : other.views)
        edit_image(view, [](media::Image& image) {
            for (size_t i = 3; i < image.rgba.size() / 2; i += 4) image.rgba[i] = 0;  // half of the matte is clear
        });
    training::TrainSettings settings = small_run(4);
    settings.resume = true;
    try {
        training::train(device(), other, settings, nvv, go_on);
        FAIL() << "resumed with other images";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("other images"), std::string::npos) << error.what();
    }
}

// `neuvv train` on a small capture in a folder.
class KilledRun : public ::testing::Test {
  protected:
    KilledRun() { write_capture(data_.path, sphere_dataset({.cameras = 6, .frames = 2, .size = 32})); }

    std::vector<std::string> command(uint64_t steps, bool resume) const {
        std::vector<std::string> words = {NEUVV_PROGRAM, "train", data_.path.string(), "-o", nvv_.string()};
        words.insert(words.end(), {"--steps", std::to_string(steps), "--resolution", "32", "--hh-degree", "1"});
        if (resume) words.push_back("--resume");
        return words;
    }
    // Resumes the run for three more steps than its state has.
    void expect_resumes() {
        const uint64_t step = training::load_checkpoint(nvv_).run.step;
        ChildProcess child(command(step + 3, true), log_);
        ASSERT_EQ(child.wait(), 0) << read_text(log_);
        EXPECT_EQ(training::load_checkpoint(nvv_).run.step, step + 3);
        EXPECT_GT(voctree::read_nvv(nvv_).leaf_count, 0u);
    }

    TemporaryFolder data_, out_;
    std::filesystem::path nvv_ = out_.path / "killed.nvv", log_ = data_.path / "log.txt";
};

TEST_F(KilledRun, LeavesAVolumeThatLoadsAndResumesAtAnyMoment) {
    for (const int delay_ms : {0, 300, 1000}) {
        SCOPED_TRACE(delay_ms);
        std::filesystem::remove(nvv_);
        std::filesystem::remove(training::state_path(nvv_));
        ChildProcess child(command(10000000, false), log_);
        ASSERT_TRUE(child.until([&] { return std::filesystem::exists(nvv_); })) << read_text(log_);
        std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
        child.send(SIGKILL);
        ASSERT_EQ(child.wait(), -SIGKILL);
        EXPECT_GT(voctree::read_nvv(nvv_).leaf_count, 0u);
        EXPECT_EQ(training::load_checkpoint(nvv_).run.step, 0u) << "the first checkpoint comes before the first step";
        expect_resumes();
    }
}

// A run that is killed between writing the two files of its first checkpoint can go on from the state alone.
TEST_F(KilledRun, ResumesFromTheStateAlone) {
    ChildProcess child(command(10000000, false), log_);
    ASSERT_TRUE(child.until([&] { return std::filesystem::exists(training::state_path(nvv_)); })) << read_text(log_);
    child.send(SIGKILL);
    child.wait();
    std::filesystem::remove(nvv_);
    expect_resumes();
}

// Ctrl-C saves a checkpoint; a kill during that saving leaves the old checkpoint or the new one.
TEST_F(KilledRun, SurvivesAKillWhileItSaves) {
    ChildProcess child(command(10000000, false), log_);
    ASSERT_TRUE(child.until([&] { return std::filesystem::exists(nvv_); })) << read_text(log_);
    // An hour ago: files of one tick of the system's clock have the same time.
    const auto before = std::filesystem::last_write_time(training::state_path(nvv_)) - std::chrono::hours(1);
    std::filesystem::last_write_time(training::state_path(nvv_), before);
    child.send(SIGINT);
    ASSERT_TRUE(child.until(
        [&] { return out_.entries() > 2 || std::filesystem::last_write_time(training::state_path(nvv_)) != before; }));
    child.send(SIGKILL);
    child.wait();
    EXPECT_GT(voctree::read_nvv(nvv_).leaf_count, 0u);
    expect_resumes();
}

TEST_F(KilledRun, CtrlCSavesAndExitsWell) {
    ChildProcess child(command(10000000, false), log_);
    ASSERT_TRUE(child.until([&] { return std::filesystem::exists(nvv_); })) << read_text(log_);
    child.send(SIGINT);
    EXPECT_EQ(child.wait(), 0) << read_text(log_);
    EXPECT_GT(training::load_checkpoint(nvv_).run.step, 0u);
    EXPECT_NE(read_text(log_).find("interrupted"), std::string::npos) << read_text(log_);
    EXPECT_NE(read_text(log_).find("--resume"), std::string::npos) << read_text(log_);
    expect_resumes();
}

// What batch systems send before the time is up, a terminal that is closed, and a reader who has gone.
TEST_F(KilledRun, TheSignalsOfBatchSystemsSaveToo) {
    for (const int signal : {SIGUSR1, SIGHUP, SIGXCPU, SIGPIPE}) {
        SCOPED_TRACE(signal);
        std::filesystem::remove(nvv_);
        std::filesystem::remove(training::state_path(nvv_));
        ChildProcess child(command(10000000, false), log_);
        ASSERT_TRUE(child.until([&] { return std::filesystem::exists(nvv_); })) << read_text(log_);
        child.send(signal);
        EXPECT_EQ(child.wait(), 0) << read_text(log_);
        EXPECT_NE(read_text(log_).find("interrupted"), std::string::npos) << read_text(log_);
    }
    expect_resumes();
}

// --preview and --metrics of a run that is interrupted: the log has the steps of both parts in order, the image exists.
TEST_F(KilledRun, ShowsItselfWhileItRuns) {
    const std::filesystem::path preview = out_.path / "live/preview.png", metrics = out_.path / "live/run.jsonl";
    const std::vector<std::string> live = {"--preview", preview.string(), "--metrics", metrics.string()};
    const auto with_live = [&](std::vector<std::string> words) {
        words.insert(words.end(), live.begin(), live.end());
        return words;
    };
    const auto steps_logged = [&] {
        std::vector<uint64_t> steps;
        std::istringstream lines(read_text(metrics));
        for (std::string line; std::getline(lines, line) && !lines.eof();)  // the last one may be being written
            steps.push_back(nlohmann::json::parse(line).at("step").get<uint64_t>());
        return steps;
    };
    ChildProcess first(with_live(command(10000000, false)), log_);
    ASSERT_TRUE(first.until([&] { return std::filesystem::exists(preview) && !steps_logged().empty(); }))
        << read_text(log_);
    first.send(SIGINT);
    ASSERT_EQ(first.wait(), 0) << read_text(log_);
    const std::vector<uint64_t> before = steps_logged();
    const media::Image image = media::read_png(preview);
    EXPECT_EQ(image.width, 3 * 32u);
    EXPECT_EQ(image.height, 32u);

    const uint64_t last = training::load_checkpoint(nvv_).run.step;
    write_text(metrics, read_text(metrics) + fmt::format("{{\"step\":{}}}\n{{\"step\":", last + 1000));
    ChildProcess second(with_live(command(last + 3, true)), log_);
    ASSERT_EQ(second.wait(), 0) << read_text(log_);
    const std::vector<uint64_t> after = steps_logged();
    ASSERT_GT(after.size(), before.size());
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
    EXPECT_EQ(after.back(), last + 3);
    EXPECT_TRUE(std::is_sorted(after.begin(), after.end()));

    ChildProcess wrong({NEUVV_PROGRAM, "train", data_.path.string(), "-o", nvv_.string(), "--preview", nvv_.string()},
                       log_);
    EXPECT_EQ(wrong.wait(), 2);
    EXPECT_NE(read_text(log_).find("--preview"), std::string::npos) << read_text(log_);
}

TEST_F(KilledRun, RefinesOnlyWhatItKnows) {
    std::vector<std::string> words = command(3, false);
    words.insert(words.end(), {"--refine", "colour"});
    ChildProcess known(words, log_);
    EXPECT_EQ(known.wait(), 0);
    EXPECT_NE(read_text(log_).find("colours of"), std::string::npos) << read_text(log_);
    words.insert(words.begin() + 2, "--overwrite");
    words.back() = "poses";
    ChildProcess poses(words, log_);
    EXPECT_EQ(poses.wait(), 0);
    EXPECT_NE(read_text(log_).find("the poses of all cameras stayed"), std::string::npos) << read_text(log_);
    words.back() = "auto";
    ChildProcess automatic(words, log_);
    EXPECT_EQ(automatic.wait(), 0);
    EXPECT_NE(read_text(log_).find("--refine auto: "), std::string::npos) << read_text(log_);
    words.insert(words.end(), {"--init", "psi"});
    ChildProcess both(words, log_);
    EXPECT_EQ(both.wait(), 2);
    EXPECT_NE(read_text(log_).find("--init psi"), std::string::npos) << read_text(log_);
    words.resize(words.size() - 2);
    for (const char* names : {"poses,time", "auto,colour"}) {
        words.back() = names;
        ChildProcess together(words, log_);
        EXPECT_EQ(together.wait(), 2);
        EXPECT_NE(read_text(log_).find(names), std::string::npos) << read_text(log_);
    }
    words.back() = "colour,lens";
    ChildProcess unknown(words, log_);
    EXPECT_EQ(unknown.wait(), 2);
    EXPECT_NE(read_text(log_).find("lens"), std::string::npos) << read_text(log_);
}

// Ctrl-C while a draft looks for errors of the rig: what it found by then is said, and the run can go on.
TEST_F(KilledRun, CtrlCInTheSearchKeepsWhatWasFound) {
    const TemporaryFolder folder;
    write_capture(folder.path, sphere_dataset({.cameras = 16, .frames = 4, .size = 96}));
    std::vector<std::string> words = command(10000000, false);
    words[2] = folder.path.string();
    words.insert(words.end(), {"--refine", "auto"});
    ASSERT_EQ(setenv("NEUVV_STATUS_MS", "1", 1), 0);
    ChildProcess child(words, log_);
    unsetenv("NEUVV_STATUS_MS");
    const std::regex kRound("round [1-9]");
    ASSERT_TRUE(child.until([&] { return std::regex_search(read_text(log_), kRound); })) << read_text(log_);
    EXPECT_FALSE(std::filesystem::exists(nvv_));
    child.send(SIGINT);
    EXPECT_EQ(child.wait(), 0) << read_text(log_);
    for (const char* said : {"a draft looks for errors of the rig for about", "the draft ended before its end",
                             "--refine auto: ", "interrupted; the same command with --resume"})
        EXPECT_NE(read_text(log_).find(said), std::string::npos) << said << " in\n" << read_text(log_);
    words = command(training::load_checkpoint(nvv_).run.step + 3, true);
    words[2] = folder.path.string();
    ChildProcess again(words, log_);
    EXPECT_EQ(again.wait(), 0) << read_text(log_);
}

TEST_F(KilledRun, ResumeWithoutAStateIsBadInput) {
    ChildProcess child(command(3, true), log_);
    EXPECT_EQ(child.wait(), 2);
    EXPECT_NE(read_text(log_).find("killed.nvv.state"), std::string::npos) << read_text(log_);
}

}  // namespace
}  // namespace neuvv::test
