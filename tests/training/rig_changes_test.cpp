// Corrections of a rig, and which of them are worth making.
#include "training/rig/rig_changes.h"

#include <gtest/gtest.h>

#include <limits>

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

// A performer who moves by 2 in each frame, seen by a camera whose pose adds 1 to all differences.
TEST(TimeEvidence, SaysHowLateTheShutterIs) {
    const auto late = [](double frames) {
        const auto error = [&](double at) { return 1 + 2 * std::abs(at - frames); };
        return training::TimeEvidence{{error(0), error(1), 2}, {error(0), error(-1), 2}};
    };
    for (const double frames : {-1.0, -0.5, -0.2, 0.0, 0.3, 0.5, 1.0})
        EXPECT_NEAR(late(frames).frames_late(), frames, 1e-12) << frames;
    EXPECT_NEAR(late(0).contrast(), 2, 1e-12);
    EXPECT_EQ((training::TimeEvidence{{1, 1, 0}, {1, 1, 0}}).frames_late(), 0);
    EXPECT_EQ((training::TimeEvidence{{1, 1, 0}, {1, 1, 0}}).contrast(), 0);
    EXPECT_EQ(training::TimeEvidence{}.contrast(), 0);
    EXPECT_EQ((training::TimeEvidence{{1, 2, 1}, {}}).contrast(), 0);  // images of one frame alone
}

}  // namespace
}  // namespace neuvv::test
