// The search for poses of cameras, on a small capture of the performer whose cameras are turned and shifted.
#include "training/run/rig_search.h"

#include <gtest/gtest.h>

#include "support/gpu_test.h"
#include "support/input_error.h"
#include "support/performer_capture.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/rig/pose_probe.h"
#include "training/tree/hull_box.h"

namespace neuvv::test {
namespace {

using RigSearchTest = GpuTest;
using training::PoseChange;

// Changes of cameras by up to about 0.6 degrees and 8 mm, without a part that all have in common.
std::vector<PoseChange> spoiling(const std::vector<stage::Camera>& cameras, glm::dvec3 centre) {
    Random random(11);
    std::vector<PoseChange> changes(cameras.size());
    for (PoseChange& change : changes)
        for (size_t i = 0; i < training::kZoom; ++i) change[i] = random.uniform(-1, 1) * 0.008;
    // Without evidence the solver takes out the common part, and pulls the rest towards 0.
    const std::vector<training::PoseEvidence> none(cameras.size());
    return training::next_poses(cameras, changes, none, centre, 1);
}

double image_error(const std::vector<stage::Camera>& truth, const std::vector<stage::Camera>& cameras,
                   glm::dvec3 centre) {
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i)
        for (const glm::dvec3& point : training::scene_points(truth[i], centre)) {
            const glm::dvec2 by = training::seen_at(cameras[i], point) - training::seen_at(truth[i], point);
            sum += glm::dot(by, by);
        }
    return std::sqrt(sum / static_cast<double>(truth.size() * training::kScenePoints));
}

TEST_F(RigSearchTest, CamerasMoveBackToWhereTheyStood) {
    const TemporaryFolder folder;
    training::Dataset dataset = performer_capture(folder.path);
    const std::vector<stage::Camera> truth = dataset.cameras;
    const auto [low, high] = training::first_box(dataset);
    const glm::dvec3 centre = 0.5 * (low + high);
    dataset.cameras = training::moved(truth, spoiling(truth, centre));
    training::TrainSettings settings;
    settings.steps = 100;
    double last_fraction = 0, motion_px = 0;
    const auto found =
        training::search_rig(device(), dataset, settings, true, [&](const training::RigSearchProgress& now) {
            EXPECT_GE(now.fraction, last_fraction);
            last_fraction = now.fraction;
            motion_px = now.motion_px;
            return true;
        });
    ASSERT_TRUE(found);
    EXPECT_EQ(last_fraction, 1);
    std::printf("spoilt cameras: images moved by %.3f pixels, unsteady by %.3f, leaves of %.0f\n", motion_px,
                found->unsteady_px, found->pixels);
    EXPECT_TRUE(training::worthwhile(*found).poses);
    EXPECT_GT(motion_px, 0.2);
    const double before = image_error(truth, dataset.cameras, centre);
    EXPECT_GT(before, 0.5);
    EXPECT_LT(image_error(truth, training::moved(dataset.cameras, found->changes.poses), centre), 0.4 * before);
}

TEST_F(RigSearchTest, StopsWhereItsCallbackSaysSo) {
    training::Dataset dataset = sphere_dataset({});
    training::TrainSettings settings;
    settings.shape.resolution = 40;
    settings.steps = 1;
    // What was found until then is kept, but not taken for certain.
    bool stopped = false;
    const auto stop = [&](const training::RigSearchProgress& now) {
        EXPECT_EQ(now.most_s, 0) << "a budget in steps bounds no time";
        stopped = now.rounds > 0;
        return !stopped;
    };
    const auto found = training::search_rig(device(), dataset, settings, true, stop);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->whole, !stopped);
    EXPECT_EQ(found->changes.poses.size(), dataset.cameras.size());
    EXPECT_EQ(found->changes.frames_late.size(), dataset.cameras.size());
    settings.steps = 0;
    settings.minutes = 0.1;
    training::search_rig(device(), dataset, settings, true, [](const training::RigSearchProgress& now) {
        EXPECT_NEAR(now.most_s, 1.2, 1e-9) << "a fifth";
        return true;
    });
}

TEST_F(RigSearchTest, TakesAFifthOfTheSteps) {
    const training::Dataset dataset = sphere_dataset({.cameras = 12, .frames = 4, .size = 48});
    training::TrainSettings settings;
    settings.shape = {.resolution = 40, .bases = 1, .hh_degree = 0};
    settings.tiles_per_step = 1;  // as few as the search allows, so that the draft has many steps
    const auto steps_of = [&](uint64_t budget) {
        settings.steps = budget;
        uint64_t steps = 0;
        const auto found =
            training::search_rig(device(), dataset, settings, true, [&](const training::RigSearchProgress& now) {
                steps = now.steps;
                return true;
            });
        EXPECT_TRUE(found && found->whole) << budget;
        return steps;
    };
    EXPECT_EQ(steps_of(400), 80u);
    EXPECT_GT(steps_of(1'000'000), 80u) << "as long as it likes";
    const uint64_t least = steps_of(3);
    EXPECT_TRUE(least >= 60 && least <= 61) << least << ": two for each round";
}

// Poses are corrected where the draft is sure of them.
TEST(RigFindings, AreWorthwhileWhereTheDraftIsSure) {
    training::RigFindings found;
    found.motion_px = {1, 1};
    found.changes.frames_late = {0, 0};
    found.late_by = {1, 1};
    found.changes.readout = {0, 0};
    found.roll_by = {1, 1};
    found.whole = true;
    found.unsteady_px = 0.1;
    EXPECT_TRUE(training::worthwhile(found).poses);
    training::RigFindings early = found, coarse = found, unsteady = found;
    early.whole = false;
    coarse.pixels = 4;
    unsteady.unsteady_px = 0.5;
    for (const training::RigFindings& doubtful : {early, coarse, unsteady})
        EXPECT_FALSE(training::worthwhile(doubtful).poses);
}

TEST_F(RigSearchTest, ExactCamerasStay) {
    const TemporaryFolder folder;
    const training::Dataset dataset = performer_capture(folder.path);
    training::TrainSettings settings;
    settings.steps = 100;
    const auto go_on = [](const training::RigSearchProgress&) { return true; };
    const auto found = training::search_rig(device(), dataset, settings, true, go_on);
    ASSERT_TRUE(found && found->whole);
    double sum = 0;
    for (const double px : found->motion_px) sum += px * px;
    std::printf("exact cameras: images moved by %.3f pixels, unsteady by %.3f, leaves of %.0f\n",
                std::sqrt(sum / static_cast<double>(found->motion_px.size())), found->unsteady_px, found->pixels);
    EXPECT_FALSE(training::worthwhile(*found).poses);
    EXPECT_FALSE(training::worthwhile(*found).time);
}

TEST_F(RigSearchTest, ARunMovesItsCamerasAndAResumedRunDoesSoAgain) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    const training::Dataset given = sphere_dataset({});
    training::TrainSettings settings;
    settings.steps = 3;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 64;
    settings.rig.poses.resize(given.cameras.size());
    settings.rig.poses[2][training::kTurnX] = 0.01;
    settings.rig.poses[5][training::kShiftY] = -0.02;
    const auto go_on = [](const training::TrainProgress&) { return true; };
    training::Dataset first = given;
    const training::TrainProgress trained = training::train(device(), first, settings, nvv, go_on);
    const std::vector<stage::Camera> expected = training::moved(given.cameras, settings.rig.poses);
    EXPECT_EQ(training::load_checkpoint(nvv).rig, settings.rig);
    ASSERT_EQ(trained.poses.size(), given.cameras.size());
    EXPECT_EQ(trained.poses[2].change, settings.rig.poses[2]);
    EXPECT_GT(trained.poses[2].motion_px, 0.1);
    EXPECT_EQ(trained.poses[3].motion_px, 0);
    training::Dataset second = given;
    settings.resume = true;
    settings.rig = {};
    settings.steps = 4;
    training::train(device(), second, settings, nvv, go_on);
    for (const training::Dataset* dataset : {&first, &second})
        for (size_t i = 0; i < expected.size(); ++i)
            EXPECT_EQ(dataset->cameras[i].world_from_camera, expected[i].world_from_camera);
    // The images of a run whose cameras have moved are those of the same data set.
    EXPECT_EQ(training::load_checkpoint(nvv).rig.poses[5][training::kShiftY], -0.02);
}

// A field that cameras see as they stand gives evidence that they should stay; where one is turned, that it should turn
// back.
TEST_F(RigSearchTest, EvidencePointsTowardsTheTruth) {
    training::Dataset dataset = sphere_dataset({.cameras = 12, .frames = 1, .size = 48});
    const TemporaryFolder folder;
    training::TrainSettings settings;
    settings.shape = {.resolution = 48, .bases = 1, .hh_degree = 1};
    settings.steps = 200;
    std::vector<PoseChange> changes(dataset.cameras.size());
    std::vector<training::PoseEvidence> evidence(dataset.cameras.size());
    const glm::dvec3 centre(0);
    settings.between_steps = [&](const training::BetweenSteps& now) {
        if (now.fraction < 0.9) return true;
        changes[4][training::kTurnY] = 0.02;  // 1.3 pixels
        const training::PoseProbe probe{dataset.cameras, changes, now.colours, centre, 1};
        training::add_evidence(now.step, probe, now.sampler.sample(0, 16, 3), 0, evidence);
        return false;
    };
    training::train(device(), dataset, settings, {}, [](const training::TrainProgress&) { return true; });
    ASSERT_GT(evidence[4].count, 0);
    const auto wanted = [&](size_t camera) {
        return evidence[camera].right[training::kTurnY] / evidence[camera].normal[training::kTurnY][training::kTurnY];
    };
    EXPECT_LT(wanted(4), -0.012);
    EXPECT_LT(std::abs(wanted(5)), 0.008);
    EXPECT_LT(evidence[5].error / evidence[5].count, evidence[4].error / evidence[4].count);
}

// Of a sphere that moves, what a camera sees whose shutter is late, and open, by so many frames; rows are read one
// after the other, for `readout` frames.
media::Image exposed(const SphereCapture& capture, const stage::Camera& camera, double time, double late,
                     double exposure, double readout) {
    constexpr uint32_t kParts = 8;
    media::Image image(capture.size, capture.size);
    const uint32_t rows = capture.size / kParts;
    const double frame = 1 / (capture.frames - 1.0);
    for (uint32_t band = 0; band < kParts; ++band) {
        const double middle = late + readout * ((band + 0.5) / kParts - 0.5);
        std::vector<double> sum(size_t{4} * capture.size * rows);
        for (uint32_t part = 0; part < kParts; ++part) {
            const double open = middle + exposure * ((part + 0.5) / kParts - 0.5);
            const media::Image now = sphere_image(capture, camera, time + frame * open);
            const uint8_t* pixels = now.at(0, band * rows);
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += i % 4 == 3 ? pixels[i] : 1.0 * pixels[i] * pixels[i | 3];
        }
        for (size_t i = 0; i < sum.size(); ++i)
            image.at(0, band * rows)[i] =
                static_cast<uint8_t>(std::lround(i % 4 == 3 ? sum[i] / kParts : sum[i] / std::max(sum[i | 3], 1.0)));
    }
    return image;
}

TEST_F(RigSearchTest, ShuttersThatDifferAreFound) {
    const SphereCapture capture{.cameras = 12, .frames = 4, .size = 64, .radius_m = 0.6, .travel_m = 0.3};
    constexpr uint32_t kLate = 1, kBlurs = 4, kRolls = 7;
    training::Dataset dataset = sphere_dataset(capture);
    for (training::View& view : dataset.views) {
        const auto shows = [&](double late, double exposure, double readout) {
            view.image = training::TiledImage(
                exposed(capture, dataset.cameras[view.camera], view.time, late, exposure, readout));
        };
        if (view.camera == kLate) shows(0.5, 0, 0);
        if (view.camera == kBlurs) shows(0, 1, 0);
        if (view.camera == kRolls) shows(0, 0, 1);
    }
    training::TrainSettings settings;
    settings.steps = 1;
    settings.shape.resolution = 64;
    const auto go_on = [](const training::RigSearchProgress&) { return true; };
    const auto found = training::search_rig(device(), dataset, settings, false, go_on);
    ASSERT_TRUE(found);
    for (uint32_t camera = 0; camera < dataset.cameras.size(); ++camera) {
        SCOPED_TRACE(camera);
        EXPECT_EQ(found->changes.poses[camera], PoseChange{});
        EXPECT_EQ(training::is_late(*found, camera), camera == kLate) << found->changes.frames_late[camera];
        EXPECT_EQ(training::is_rolling(*found, camera), camera == kRolls) << found->changes.readout[camera];
        EXPECT_EQ(found->blur[camera] > training::kWorthBlur, camera == kBlurs) << found->blur[camera];
    }
    EXPECT_GT(found->changes.frames_late[kLate], 0.2);
    EXPECT_GT(found->changes.readout[kRolls], 0.6);
    EXPECT_TRUE(training::worthwhile(*found).time);
    EXPECT_TRUE(training::left_out({{}, found->changes.frames_late})[kLate]);
}

TEST_F(RigSearchTest, ARunLeavesOutWhoIsBetweenFramesAgainWhenItIsResumed) {
    const TemporaryFolder folder;
    const training::Dataset given = sphere_dataset({});
    training::TrainSettings settings;
    settings.steps = 3;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 64;
    settings.rig.frames_late.resize(given.cameras.size());
    settings.rig.frames_late[4] = 0.5;
    settings.rig.readout.resize(given.cameras.size());
    settings.rig.readout[5] = 5;
    const auto go_on = [](const training::TrainProgress&) { return true; };
    for (const bool resume : {false, true}) {
        training::Dataset dataset = given;
        settings.resume = resume;
        ++settings.steps;
        training::train(device(), dataset, settings, folder.path / "sphere.nvv", go_on);
        settings.rig = {};
        EXPECT_EQ(dataset.views.size(), given.views.size() - 6);
        EXPECT_EQ(training::load_checkpoint(folder.path / "sphere.nvv").rig.frames_late[4], 0.5);
        EXPECT_EQ(training::load_checkpoint(folder.path / "sphere.nvv").rig.readout[5], 5);
    }
}

}  // namespace
}  // namespace neuvv::test
