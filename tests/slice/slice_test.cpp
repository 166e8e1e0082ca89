// What is wrong with slices, slices of fewer leaves, and slices in whole numbers.
#include "slice/slice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "base/sigmoid.h"
#include "media/image.h"
#include "slice/cell_code.h"
#include "slice/coarser.h"
#include "slice/quantise.h"

namespace neuvv::test {
namespace {

// Leaves of depths 2 to 4 in an oblong box, about half of the cells, with harmonics of degree 2.
slice::Slice some_slice() {
    std::mt19937 random(7);
    const auto between = [&](float least, float most) {
        return std::uniform_real_distribution<float>(least, most)(random);
    };
    slice::Slice slice{{-1, 0, 2}, {1, 2, 3}, 4, 2, {}};
    for (uint64_t cell = 0; cell < 4096;) {
        const uint32_t depth = cell % 64 == 0 && between(0, 1) < 0.3f  ? 2
                               : cell % 8 == 0 && between(0, 1) < 0.3f ? 3
                                                                       : 4;
        if (between(0, 1) < 0.5f) {
            slice::Leaf leaf{cell, depth, between(0.1f, 40), {}, 0};
            for (auto& channel : leaf.colours)
                for (uint32_t k = 0; k < 9; ++k) channel[k] = between(-1, 1) * (k == 0 ? 4 : 0.5f);
            leaf.shown = slice.shown_alone(leaf);
            slice.leaves.push_back(leaf);
        }
        cell += uint64_t{1} << 3 * (4 - depth);
    }
    return slice;
}

double summed_density(const slice::Slice& slice) {
    double sum = 0;
    for (const slice::Leaf& leaf : slice.leaves) sum += double{leaf.sigma} * std::exp2(-3.0 * leaf.depth);
    return sum;
}

TEST(Slice, OfFewerLeavesHidesAsMuch) {
    const slice::Slice whole = some_slice();
    const size_t count = whole.leaves.size();
    for (const size_t most : {count - 1, count / 2, count / 10, size_t{1}}) {
        const slice::Slice fewer = slice::with_fewer_leaves(whole, most);
        EXPECT_LE(fewer.leaves.size(), most == 1 ? 8 : most);
        EXPECT_GE(fewer.leaves.size(), most == 1 ? 1 : most - 7) << "no more is merged than has to be";
        EXPECT_NEAR(summed_density(fewer), summed_density(whole), 1e-4 * summed_density(whole));
        for (size_t i = 1; i < fewer.leaves.size(); ++i) EXPECT_LT(fewer.leaves[i - 1].cell, fewer.leaves[i].cell);
    }
    EXPECT_EQ(slice::with_fewer_leaves(whole, count).leaves.size(), count);
}

// Two groups of eight cells: one of the same leaves, one whose leaves differ.
TEST(Slice, MergesWhatAgrees) {
    slice::Slice slice;
    for (uint64_t i = 0; i < 16; ++i) {
        slice::Leaf leaf{i, 2, 3, {}, 1};
        for (auto& channel : leaf.colours) channel[0] = i < 8 && i % 2 == 0 ? 3.0f : 1.0f;
        slice.leaves.push_back(leaf);
    }
    const slice::Slice fewer = slice::with_fewer_leaves(slice, 9);
    ASSERT_EQ(fewer.leaves.size(), 9u);
    EXPECT_EQ(fewer.leaves[8].cell, 8u);
    EXPECT_EQ(fewer.leaves[8].depth, 1u);
    EXPECT_FLOAT_EQ(fewer.leaves[8].sigma, 3);
    EXPECT_NEAR(fewer.leaves[8].colours[0][0], 1, 1e-6);
}

TEST(Slice, OfADepthHasNoFinerLeaves) {
    const slice::Slice whole = some_slice(), coarse = slice::with_depth(whole, 2);
    EXPECT_EQ(coarse.depth, 2u);
    EXPECT_EQ(slice::defect_of(coarse), "");
    EXPECT_NEAR(summed_density(coarse), summed_density(whole), 1e-4 * summed_density(whole));
}

TEST(Slice, SaysWhatIsWrongWithIt) {
    const auto defect = [](const auto& change) {
        slice::Slice slice = some_slice();
        change(slice);
        return slice::defect_of(slice);
    };
    constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(defect([](slice::Slice&) {}), "");
    EXPECT_EQ(defect([](slice::Slice& s) { s.leaves.clear(); }), "");
    EXPECT_EQ(defect([](slice::Slice& s) { s.depth = 13; }), "has a depth of 13");
    EXPECT_EQ(defect([](slice::Slice& s) { s.degree = 4; }), "has harmonics of degree 4");
    EXPECT_EQ(defect([](slice::Slice& s) { s.box_size.y = 0; }), "has no box");
    EXPECT_EQ(defect([](slice::Slice& s) { s.leaves[3].depth = 5; }), "leaf 3 is at depth 5 of 4");
    EXPECT_EQ(defect([](slice::Slice& s) {
                  s.leaves[0] = {1, 3, 1, {}, 0};
              }),
              "leaf 0 does not lie on a cell of its depth");
    const size_t last = some_slice().leaves.size() - 1;
    EXPECT_EQ(defect([](slice::Slice& s) {
                  s.leaves.back() = {4096, 4, 1, {}, 0};
              }),
              "leaf " + std::to_string(last) + " does not lie on a cell of its depth");
    EXPECT_EQ(defect([](slice::Slice& s) { std::swap(s.leaves[4], s.leaves[5]); }),
              "leaf 5 overlaps the one before it, or is not in order");
    EXPECT_EQ(defect([](slice::Slice& s) { s.leaves[1].sigma = -1; }), "leaf 1 has a density of -1");
    EXPECT_EQ(defect([&](slice::Slice& s) { s.leaves[1].colours[2][8] = kNoNumber; }),
              "leaf 1 has a colour that is no number");
    EXPECT_EQ(defect([&](slice::Slice& s) { s.leaves[1].colours[2][9] = kNoNumber; }), "") << "of no degree it has";
}

double srgb_of(float k00) {
    return media::srgb_from_linear(double{sigmoid(k00 * slice::kMeanHarmonic)});
}

// Whole numbers are rounded to half of one: of opacity, and of the three planes of a colour in sRGB.
TEST(Slice, InWholeNumbersIsTheSameUpToRounding) {
    const slice::Slice slice = some_slice();
    const stream::QuantisedSlice whole = slice::quantised(slice);
    const slice::Slice again = slice::values_of(whole, slice.box_min, slice.box_size);
    EXPECT_EQ(slice::defect_of(again), "");
    ASSERT_EQ(again.leaves.size(), slice.leaves.size());
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        const slice::Leaf &a = slice.leaves[i], &b = again.leaves[i];
        EXPECT_EQ(a.cell, b.cell);
        EXPECT_EQ(a.depth, b.depth);
        EXPECT_NEAR(slice.opacity(a), again.opacity(b), 0.51 / stream::kUnit);
        EXPECT_FLOAT_EQ(b.shown, again.opacity(b) * again.edge_m(b) * again.edge_m(b));
        for (size_t c = 0; c < 3; ++c) {
            const double mean = srgb_of(a.colours[c][0]);
            EXPECT_NEAR(mean, srgb_of(b.colours[c][0]), 2.0 / stream::kUnit);
            if (mean < 0.2 || mean > 0.8) continue;  // there, a unit is much of a harmonic's coefficient
            for (size_t k = 1; k < 9; ++k) EXPECT_NEAR(double{a.colours[c][k]}, double{b.colours[c][k]}, 0.03) << mean;
        }
    }
    // Numbers that are whole are kept.
    const stream::QuantisedSlice twice = slice::quantised(again);
    EXPECT_EQ(whole.leaves, twice.leaves);
    EXPECT_EQ(whole.planes, twice.planes);
}

TEST(Slice, InOtherLengthsIsTheSame) {
    const slice::Slice slice = some_slice(), twice = slice::scaled(slice, 2, {1, 0, -1});
    EXPECT_EQ(slice::finest_depth(twice), 4u);
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        EXPECT_FLOAT_EQ(twice.optical_depth(twice.leaves[i]), slice.optical_depth(slice.leaves[i]));
        EXPECT_FLOAT_EQ(twice.shown_alone(twice.leaves[i]), twice.leaves[i].shown);
        const glm::vec3 centre = 2.0f * slice.centre_m(slice.leaves[i]) + glm::vec3(1, 0, -1);
        EXPECT_LT(glm::distance(twice.centre_m(twice.leaves[i]), centre), 1e-5f);
    }
}

TEST(Slice, CellsHaveCodesInTheOrderOfAWalk) {
    EXPECT_EQ(slice::code_of({1, 0, 0}), 1u);
    EXPECT_EQ(slice::code_of({0, 1, 0}), 2u);
    EXPECT_EQ(slice::code_of({0, 0, 1}), 4u);
    EXPECT_EQ(slice::code_of({4095, 4095, 4095}), (uint64_t{1} << 36) - 1);
    const glm::uvec3 cell(2730, 1365, 7);
    EXPECT_EQ(slice::cell_of(slice::code_of(cell)), cell);
    EXPECT_EQ(slice::code_of({4096, 0, 0}), 0u) << "higher bits are ignored";
}

}  // namespace
}  // namespace neuvv::test
