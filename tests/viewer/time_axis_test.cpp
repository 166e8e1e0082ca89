#include "tools/viewer/timeline/time_axis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace neuvv {
namespace {

constexpr viewer::TimeLimits kSixSeconds{6, 25, 10};

viewer::TimeAxis whole() {
    viewer::TimeAxis axis;
    axis.left = 100;
    axis.width = 620;
    return viewer::fitted(axis, kSixSeconds);
}

TEST(TimeAxis, FitsAllBetweenItsMargins) {
    const viewer::TimeAxis axis = whole();
    EXPECT_NEAR(axis.x_at(0), 110, 1e-9);
    EXPECT_NEAR(axis.x_at(6), 710, 1e-9);
    EXPECT_NEAR(axis.s_at(410), 3, 1e-12);
    EXPECT_NEAR(axis.end_s(), 6.1, 1e-12);
}

TEST(TimeAxis, ZoomsAboutThePointerUpToItsLimits) {
    const viewer::TimeAxis closer = viewer::zoomed(whole(), 410, 3, kSixSeconds);
    EXPECT_NEAR(closer.s_per_px, 0.01 * 0.8 * 0.8 * 0.8, 1e-12);
    EXPECT_NEAR(closer.s_at(410), 3, 1e-12);
    const viewer::TimeAxis back = viewer::zoomed(closer, 410, -3, kSixSeconds);
    EXPECT_NEAR(back.s_per_px, 0.01, 1e-12);
    EXPECT_NEAR(back.begin_s, -0.1, 1e-9);
    const viewer::TimeAxis farthest = viewer::zoomed(closer, 300, -100, kSixSeconds);
    EXPECT_NEAR(farthest.s_per_px, 0.01, 1e-12) << "never more than all";
    const viewer::TimeAxis closest = viewer::zoomed(whole(), 410, 1000, kSixSeconds);
    EXPECT_NEAR(1 / (25 * closest.s_per_px), viewer::kMaxFrameWidth * kSixSeconds.margin_px, 1e-6);
    EXPECT_NEAR(closest.s_at(410), 3, 1e-9);
}

TEST(TimeAxis, ScrollsWithinWhatThereIs) {
    const viewer::TimeAxis closer = viewer::zoomed(whole(), 410, 3, kSixSeconds);
    const viewer::TimeAxis moved = viewer::scrolled(closer, 50, kSixSeconds);
    EXPECT_NEAR(moved.x_at(3), 460, 1e-9);
    const viewer::TimeAxis first = viewer::scrolled(closer, 1e6, kSixSeconds),
                           last = viewer::scrolled(closer, -1e6, kSixSeconds);
    EXPECT_NEAR(first.x_at(0), 110, 1e-9);
    EXPECT_NEAR(last.x_at(6), 710, 1e-9);
    EXPECT_NEAR(viewer::scrolled(whole(), -200, kSixSeconds).begin_s, whole().begin_s, 1e-12) << "all is in view";
}

TEST(TimeAxis, ShowsAStageOfNoLength) {
    viewer::TimeAxis axis;
    axis.width = 0;
    axis = viewer::fitted(axis, {0, 25, 10});
    EXPECT_GT(axis.s_per_px, 0);
    EXPECT_TRUE(std::isfinite(axis.s_at(axis.x_at(1))));
}

TEST(TimeAxis, MarksAreFarEnoughApart) {
    for (const double fps : {0.5, 12.0, 23.976, 25.0, 60.0, 1000.0})
        for (double s_per_px = 1e-6; s_per_px < 50; s_per_px *= 1.3) {
            const viewer::TimeMarks marks = viewer::marks_for(s_per_px, fps, 54, 5);
            ASSERT_GE(marks.major_s / s_per_px, 54 * (1 - 1e-9)) << fps << " " << s_per_px;
            if (marks.parts > 1) {
                ASSERT_GE(marks.major_s / marks.parts / s_per_px, 5 * (1 - 1e-9));
            }
            if (marks.frames) {
                ASSERT_NEAR(marks.major_s * fps, std::round(marks.major_s * fps), 1e-9);
            }
        }
}

TEST(TimeAxis, MarksAreImagesFromCloseAndSecondsFromFar) {
    const viewer::TimeMarks close = viewer::marks_for(0.001, 25, 54, 5);
    EXPECT_TRUE(close.frames);
    EXPECT_DOUBLE_EQ(close.major_s, 0.08);
    EXPECT_EQ(close.parts, 2);
    EXPECT_EQ(viewer::label_of(close, 3, 25), "6 f");
    const viewer::TimeMarks seconds = viewer::marks_for(0.0075, 25, 54, 5);
    EXPECT_FALSE(seconds.frames);
    EXPECT_EQ(seconds.major_s, 1);
    EXPECT_EQ(seconds.parts, 25) << "a mark an image";
    EXPECT_EQ(viewer::label_of(seconds, 3, 25), "3 s");
    const viewer::TimeMarks minutes = viewer::marks_for(0.5, 25, 54, 5);
    EXPECT_EQ(minutes.major_s, 30);
    EXPECT_EQ(viewer::label_of(minutes, 3, 25), "1:30");
    EXPECT_EQ(viewer::label_of(minutes, -1, 25), "");
}

TEST(TimeAxis, FindsTheImageThatIsNearest) {
    EXPECT_DOUBLE_EQ(viewer::nearest_frame_time(1.27, 25), 1.28);
    EXPECT_DOUBLE_EQ(viewer::nearest_frame_time(-0.05, 10), -0.1);
}

}  // namespace
}  // namespace neuvv
