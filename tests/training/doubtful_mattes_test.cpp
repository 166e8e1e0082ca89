// Mattes that contradict all others are found and do not carve; right mattes are left as they are.
#include "training/tree/doubtful_mattes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "support/armed_figure.h"
#include "training/tree/hull.h"

namespace neuvv::test {
namespace {

std::set<size_t> doubted(const std::vector<training::DoubtfulMatte>& mattes) {
    std::set<size_t> views;
    for (const training::DoubtfulMatte& matte : mattes) views.insert(matte.view);
    return views;
}

std::vector<uint32_t> hull_of(const training::Dataset& dataset) {
    return training::carve(dataset, training::grid_cells({glm::dvec3(-1), glm::dvec3(1)}, training::kBoxGrid));
}

// The bits of `a` that are not set in `b`.
int bits_beyond(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    int count = 0;
    for (size_t i = 0; i < a.size(); ++i) count += std::popcount(a[i] & ~b[i]);
    return count;
}

void expect_untouched(training::Dataset dataset) {
    const training::Dataset before = dataset;
    EXPECT_TRUE(training::ignore_doubtful_mattes(dataset).empty());
    for (size_t i = 0; i < dataset.views.size(); ++i) {
        EXPECT_TRUE(dataset.views[i].ignored.empty()) << i;
        EXPECT_EQ(dataset.views[i].image, before.views[i].image) << i;
    }
    EXPECT_EQ(hull_of(dataset), hull_of(before));
}

// The doubtful mattes are those given. The true hull stays, and it is nowhere larger than that of the other images.
void expect_repaired(training::Dataset spoilt, const training::Dataset& truth, const std::set<size_t>& wrong) {
    training::Dataset others = spoilt;
    others.views.clear();
    for (size_t i = 0; i < spoilt.views.size(); ++i)
        if (!wrong.contains(i)) others.views.push_back(spoilt.views[i]);
    EXPECT_GT(bits_beyond(hull_of(truth), hull_of(spoilt)), 100) << "were the mattes left as they are";
    EXPECT_EQ(doubted(training::ignore_doubtful_mattes(spoilt)), wrong);
    EXPECT_EQ(bits_beyond(hull_of(truth), hull_of(spoilt)), 0);
    EXPECT_EQ(bits_beyond(hull_of(spoilt), hull_of(others)), 0);
}

TEST(DoubtfulMattes, RightMattesAreLeftAsTheyAre) {
    for (const uint32_t cameras : {5u, 8u, 13u, 24u}) {
        SCOPED_TRACE(cameras);
        expect_untouched(armed_figure(cameras));
    }
}

TEST(DoubtfulMattes, ImagesMayCutTheFigure) {
    for (const double lowered : {12.0, 20.0, 28.0}) {
        SCOPED_TRACE(lowered);
        expect_untouched(armed_figure(13, lowered));
    }
}

TEST(DoubtfulMattes, TheBoxMayLeaveOutAPart) {
    training::Dataset dataset = armed_figure(13);
    for (const double half : {0.5, 0.3}) {
        SCOPED_TRACE(half);
        dataset.box = {glm::dvec3(-half), glm::dvec3(half)};
        expect_untouched(dataset);
    }
}

TEST(DoubtfulMattes, AnEmptyMatteDoesNotCarve) {
    const training::Dataset truth = armed_figure(13);
    training::Dataset spoilt = truth;
    fill(spoilt, 6 * kFigureFrames + 1, false);
    expect_repaired(spoilt, truth, {6 * kFigureFrames + 1});
    const std::vector<training::DoubtfulMatte> found = training::ignore_doubtful_mattes(spoilt);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_GT(found[0].share, 0.99f) << "all of the body but cells at the image's edge";
}

// Five of 52 images, two of them of the same time.
TEST(DoubtfulMattes, ATenthOfTheImagesLackAnArm) {
    const training::Dataset truth = armed_figure(13);
    training::Dataset spoilt = truth;
    const std::set<size_t> wrong = {3 * kFigureFrames, 2 * kFigureFrames, 5 * kFigureFrames + 1, 9 * kFigureFrames + 2,
                                    12 * kFigureFrames + 3};
    for (const size_t view : wrong) cut_arm(spoilt, view);
    expect_repaired(spoilt, truth, wrong);
}

// What the matte lacks teaches nothing; what it has stays.
TEST(DoubtfulMattes, ThePixelsOfTheArmAreIgnored) {
    training::Dataset dataset = armed_figure(13);
    cut_arm(dataset, 3 * kFigureFrames);
    const training::Dataset spoilt = dataset;
    ASSERT_EQ(training::ignore_doubtful_mattes(dataset).size(), 1u);
    const training::View& view = dataset.views[3 * kFigureFrames];
    size_t pixel = 0, arm_pixels = 0, ignored_pixels = 0;
    paint_view(dataset, 3 * kFigureFrames, [&](const uint8_t*, bool body, bool arm) {
        const bool ignored = view.ignored[pixel++];
        ignored_pixels += ignored ? 1 : 0;
        arm_pixels += arm && !body ? 1 : 0;
        EXPECT_EQ(ignored || !(arm && !body), true);
        EXPECT_FALSE(ignored && body);
    });
    EXPECT_GT(arm_pixels, 20u);
    EXPECT_LT(ignored_pixels, view.ignored.size() / 4) << "the background far from the body is known";
    EXPECT_EQ(view.image, spoilt.views[3 * kFigureFrames].image) << "what is ignored was transparent";
}

TEST(DoubtfulMattes, MattesThatAreAllForegroundCastNoDoubtOnOthers) {
    training::Dataset dataset = armed_figure(13);
    for (const size_t view : {size_t{0}, size_t{4 * kFigureFrames}, size_t{7 * kFigureFrames + 2}})
        fill(dataset, view, true);
    expect_untouched(dataset);
}

TEST(DoubtfulMattes, FewImagesAreNoEvidence) {
    for (const uint32_t cameras : {3u, 4u}) {
        SCOPED_TRACE(cameras);
        training::Dataset dataset = armed_figure(cameras);
        fill(dataset, 0, false);
        cut_arm(dataset, kFigureFrames + 2);
        expect_untouched(dataset);
    }
}

}  // namespace
}  // namespace neuvv::test
