// Corrections of a rig, and which of them are worth making.
#include "training/rig/rig_changes.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <utility>

#include "support/input_error.h"
#include "support/sphere_capture.h"
#include "training/rig/time_probe.h"
#include "training/run/rig_search.h"

namespace neuvv::test {
namespace {

using training::RigChanges;

training::Dataset small_capture() {
    return sphere_dataset({.cameras = 8, .frames = 4, .size = 16});
}

std::vector<double> times_of(const training::Dataset& dataset, uint32_t camera) {
    std::vector<double> times;
    for (const training::View& view : dataset.views)
        if (view.camera == camera) times.push_back(view.time);
    return times;
}

TEST(RigChanges, WithoutNumbersNothingChanges) {
    training::Dataset dataset = small_capture();
    training::apply({}, dataset);
    EXPECT_EQ(dataset.views.size(), 32u);
    EXPECT_EQ(dataset.cameras[3].world_from_camera, small_capture().cameras[3].world_from_camera);
}

TEST(RigChanges, ImagesMoveByWholeFrames) {
    training::Dataset dataset = small_capture();
    RigChanges changes;
    changes.frames_late = {0, 1.1, -0.9, 0.1, 0, 0, 0, 0};
    training::apply(changes, dataset);
    EXPECT_EQ(times_of(dataset, 0), dataset.times);
    EXPECT_EQ(times_of(dataset, 3), dataset.times);
    // The image of the last frame shows what comes after the clip.
    EXPECT_EQ(times_of(dataset, 1), std::vector<double>(dataset.times.begin() + 1, dataset.times.end()));
    EXPECT_EQ(times_of(dataset, 2), std::vector<double>(dataset.times.begin(), dataset.times.end() - 1));
    // Images keep their pixels: that of camera 1 which was the first is now the second frame's.
    const auto moved = std::ranges::find_if(dataset.views, [](const training::View& view) { return view.camera == 1; });
    EXPECT_EQ(moved->name, "c01_f000");
}

TEST(RigChanges, ImagesBetweenFramesAreLeftOut) {
    training::Dataset dataset = small_capture();
    RigChanges changes;
    changes.frames_late = {0, 0.5, -0.6, 0.1, 0, 0, 0, 0};
    EXPECT_EQ(training::left_out(changes), (std::vector<bool>{false, true, true, false, false, false, false, false}));
    training::apply(changes, dataset);
    EXPECT_EQ(dataset.views.size(), 24u);
    EXPECT_TRUE(times_of(dataset, 1).empty());
    EXPECT_EQ(times_of(dataset, 3).size(), 4u);
    EXPECT_EQ(dataset.cameras.size(), 8u);
}

TEST(RigChanges, ImagesOfRollingShuttersAreLeftOut) {
    RigChanges changes;
    changes.frames_late = {0, 0, 0.5, 0, 0, 0, 0, 0};
    changes.readout = {0.3, -0.6, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(training::left_out(changes), (std::vector<bool>{false, true, true, false, false, false, false, false}));
    changes.readout[3] = 0.6;  // with this one they would be more than a quarter: late ones alone are left out
    EXPECT_EQ(training::left_out(changes), (std::vector<bool>{false, false, true, false, false, false, false, false}));
}

TEST(RigChanges, NoFrameLosesAllItsImages) {
    training::Dataset dataset = small_capture();
    RigChanges changes;
    changes.frames_late.assign(8, 1.0);  // the first frame would be empty
    expect_input_error([&] { training::apply(changes, dataset); }, {"no image is left", "without correcting times"});
}

TEST(RigChanges, ARigWithoutCommonFramesKeepsItsImages) {
    RigChanges changes;
    changes.frames_late = {0, 0.5, -0.6, 0.4, 0, 0, 0, 0};
    EXPECT_EQ(training::left_out(changes), std::vector<bool>(8, false));
}

// What a clean rig of two cameras gives.
training::RigFindings clean() {
    training::RigFindings findings;
    findings.changes.poses.resize(2);
    findings.changes.frames_late = {0.02, -0.05};
    findings.late_by = {0.01, 0.01};
    findings.changes.readout = {0.1, -0.1};
    findings.roll_by = {0.05, 0.05};
    findings.blur = {0, 0};
    findings.colours = training::CameraColours(2, 2, {true, true, true});
    findings.motion_px = {0.1, 0.2};
    findings.whole = true;
    return findings;
}

TEST(RigFindings, OnlyWhatIsWorthItIsRefined) {
    const auto none = training::worthwhile(clean());
    EXPECT_FALSE(none.colour.any() || none.poses || none.time);
    training::RigFindings findings = clean();
    findings.motion_px[1] = 1;
    EXPECT_TRUE(training::worthwhile(findings).poses);
    findings.whole = false;  // the draft ended early
    EXPECT_FALSE(training::worthwhile(findings).poses);
    findings = clean();
    findings.changes.frames_late[0] = -0.5;
    EXPECT_TRUE(training::worthwhile(findings).time);
    findings.motion_px[1] = 1;  // a camera that stands elsewhere seems late
    EXPECT_FALSE(training::worthwhile(findings).time);
    findings.motion_px[1] = 0.1;
    findings.late_by[0] = std::numeric_limits<double>::infinity();  // nothing moves, so that nothing is known
    EXPECT_FALSE(training::worthwhile(findings).time);
    findings = clean();
    findings.changes.readout[1] = -0.6;
    EXPECT_TRUE(training::worthwhile(findings).time);
    findings.roll_by[1] = 0.3;  // not known well enough
    EXPECT_FALSE(training::worthwhile(findings).time);
    findings = clean();
    findings.colours.values[1].rows[0].r = 1.15f;
    EXPECT_TRUE(training::worthwhile(findings).colour.colour);
    EXPECT_FALSE(training::worthwhile(findings).colour.exposure);
    findings = clean();
    findings.colours.exposures.values = {0.1f, -0.1f, -0.1f, 0.1f};
    EXPECT_TRUE(training::worthwhile(findings).colour.exposure);
    EXPECT_FALSE(training::worthwhile(findings).colour.vignetting);
    findings = clean();
    findings.colours.vignettes.values = {-0.3f, 0, 0.3f, 0};
    EXPECT_TRUE(training::worthwhile(findings).colour.vignetting);
    findings.colours = {};
    EXPECT_FALSE(training::worthwhile(findings).colour.any());
}

// What an edge says that moves by `motion` pixels a frame, of a camera that sees it somewhere from `from` to `to`
// frames late while its shutter is open. The render is 1 behind the edge of each frame, 0 before it.
training::TimeEvidence edge_evidence(const std::array<double, training::kRowBands>& motion,
                                     const std::function<std::pair<double, double>(size_t)>& open) {
    training::TimeEvidence evidence;
    constexpr int kSteps = 1000;
    for (size_t band = 0; band < motion.size(); ++band) {
        const auto [from, to] = open(band);
        for (int step = -kSteps; step < kSteps; ++step) {
            const double at = (step + 0.5) / kSteps;  // frames
            const double image =
                to > from ? std::clamp((to - at) / (to - from), 0.0, 1.0) : static_cast<double>(at < from);
            const double own = at < 0 ? 1 : 0, width = motion[band] / kSteps;
            const double next = at < 1 ? 1 : 0, previous = at < -1 ? 1 : 0;
            const auto add = [&](training::TimeEvidence::Sums& sums, double beside) {
                sums.along += (image - own) * (beside - own) * width;
                sums.motion += (beside - own) * (beside - own) * width;
                sums.error += (image - own) * (image - own) * width;
            };
            add(evidence.next[band], next);
            add(evidence.previous[band], previous);
        }
    }
    return evidence;
}

TEST(TimeEvidence, SaysHowLateTheShutterIs) {
    std::array<double, training::kRowBands> motion{2, 2, 0, 1, 3, 2, 0, 1};
    for (const double late : {-1.0, -0.5, -0.2, 0.0, 0.3, 0.5, 1.0}) {
        const training::TimeEvidence evidence = edge_evidence(motion, [&](size_t) { return std::pair(late, late); });
        EXPECT_NEAR(evidence.frames_late(), late, 1e-3) << late;
        EXPECT_NEAR(evidence.readout().frames, 0, 1e-9) << late;
        EXPECT_NEAR(evidence.blur(), 0, 1e-9) << late;
        if (late == 0.5) {
            EXPECT_NEAR(evidence.contrast(), 1.414, 1e-3) << "half of the motion, on both sides";
        }
    }
    motion.fill(0);
    const training::TimeEvidence still = edge_evidence(motion, [](size_t) { return std::pair(0.0, 0.0); });
    EXPECT_EQ(still.frames_late(), 0);
    EXPECT_EQ(still.readout().frames, 0);
    EXPECT_EQ(still.blur(), 0);
    EXPECT_EQ(still.contrast(), 0);
    training::TimeEvidence one_side;
    one_side.next[0] = {1, 2, 1};
    EXPECT_EQ(one_side.frames_late(), 0);
    EXPECT_EQ(one_side.contrast(), 0);
}

TEST(TimeEvidence, SaysHowLongAShutterRolls) {
    std::array<double, training::kRowBands> motion{2, 2, 0, 1, 3, 2, 0, 1};
    for (const double readout : {-0.6, 0.4, 1.0}) {
        const auto evidence = edge_evidence(motion, [&](size_t band) {
            const double late = readout * ((static_cast<double>(band) + 0.5) / training::kRowBands - 0.5);
            return std::pair(late, late);
        });
        EXPECT_NEAR(evidence.readout().frames, readout, 5e-3);
        EXPECT_LT(evidence.readout().deviation, 5e-3) << "a line";
    }
    const auto zigzag = edge_evidence(motion, [](size_t band) {
        const double late = band % 2 ? 0.4 : -0.4;
        return std::pair(late, late);
    });
    EXPECT_GT(zigzag.readout().deviation, std::abs(zigzag.readout().frames));
    motion.fill(1e-6);
    motion[3] = motion[5] = 1;  // two bands always lie on a line
    EXPECT_EQ(edge_evidence(motion, [](size_t) { return std::pair(0.3, 0.3); }).readout().frames, 0);
}

TEST(TimeEvidence, SaysHowLongAnExposureIs) {
    std::array<double, training::kRowBands> motion;
    motion.fill(1);
    for (const double exposure : {0.25, 0.5, 1.0}) {
        const auto evidence = edge_evidence(motion, [&](size_t) { return std::pair(-exposure / 2, exposure / 2); });
        EXPECT_NEAR(evidence.blur(), exposure, 1e-2);
        EXPECT_NEAR(evidence.frames_late(), 0, 1e-3);
    }
}

}  // namespace
}  // namespace neuvv::test
