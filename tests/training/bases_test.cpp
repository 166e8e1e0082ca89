// The temporal bases with which training begins, and weights that give chosen values over time.
#include "training/tree/bases.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_tree.h"

namespace neuvv::test {
namespace {

TEST(Bases, HatRowsSumToOne) {
    for (const auto& [frames, bases] : {std::pair(1u, 1u), {9u, 1u}, {9u, 2u}, {10u, 4u}, {75u, 31u}, {64u, 64u}}) {
        const std::vector<float> basis = voctree::hat_basis(frames, bases);
        ASSERT_EQ(basis.size(), size_t{frames} * bases);
        for (uint32_t t = 0; t < frames && bases > 1; ++t) {
            float sum = 0;
            for (uint32_t c = 0; c < bases; ++c) sum += basis[t * bases + c];
            EXPECT_NEAR(sum, 1, 1e-5) << frames << ' ' << bases << ' ' << t;
        }
        EXPECT_EQ(basis.front(), 1);
        EXPECT_EQ(basis.back(), 1);
        for (const float value : basis) EXPECT_GE(value, 0);
    }
}

TEST(Bases, OneBasisIsConstant) {
    for (const float value : voctree::hat_basis(9, 1)) EXPECT_EQ(value, 1);
}

TEST(Bases, AsManyBasesAsFramesAreTheIdentity) {
    const std::vector<float> basis = voctree::hat_basis(12, 12);
    for (uint32_t t = 0; t < 12; ++t)
        for (uint32_t c = 0; c < 12; ++c) EXPECT_EQ(basis[t * 12 + c], t == c ? 1.0f : 0.0f);
}

// Between two frames a time reads both rows, at a frame and beyond the clip one of them.
TEST(Bases, TimesReadTheRowsAroundThem) {
    const auto expect = [](double frame, uint32_t first, uint32_t second, double part) {
        const TimeRows<double> time = rows_of_time(frame, 5);
        EXPECT_EQ(time.first, first) << frame;
        EXPECT_EQ(time.second, second) << frame;
        EXPECT_DOUBLE_EQ(time.part, part) << frame;
    };
    expect(-3, 0, 1, 0);
    expect(0, 0, 1, 0);
    expect(1.25, 1, 2, 0.25);
    expect(3, 3, 4, 0);
    expect(4, 4, 4, 0);
    expect(99, 4, 4, 0);
    static_assert(rows_of_time(0.5f, 1).first == 0 && rows_of_time(0.5f, 1).second == 0);
    const std::vector<float> table = {0, 10, 1, 20, 4, 40};
    EXPECT_EQ(voctree::row_at(table, 2, 1.5, 3), (std::vector<float>{2.5f, 30}));
    EXPECT_EQ(voctree::row_at(table, 2, 7, 3), (std::vector<float>{4, 40}));
    EXPECT_EQ(voctree::row_product(table.data() + 2, table.data(), 2), 200);
}

TEST(Bases, GammaSweepsItsRangeAndNeverStartsAtTheZeroOfOddDegrees) {
    for (const uint32_t bases : {1u, 2u, 31u}) {
        const std::vector<float> weights = voctree::initial_gamma_weights(bases);
        ASSERT_EQ(weights.size(), bases);
        for (uint32_t c = 1; c < bases; ++c) EXPECT_GT(weights[c], weights[c - 1]);
        const auto share = [](float weight) { return 1 / (1 + std::exp(-static_cast<double>(weight))); };
        if (bases == 1) {
            EXPECT_GT(std::abs(share(weights[0]) - 0.5), 0.1);
        }
        if (bases == 1) continue;
        EXPECT_NEAR(share(weights.front()), 0.1, 1e-6);
        EXPECT_NEAR(share(weights.back()), 0.9, 1e-6);
    }
}

TEST(CourseSolver, FindsTheWeightsOfACourseInTheSpan) {
    Random random(1);
    for (const auto& [frames, bases] : {std::pair(1u, 1u), {10u, 4u}, {24u, 24u}, {75u, 31u}}) {
        const std::vector<float> basis = voctree::hat_basis(frames, bases);
        std::vector<float> truth(bases), values(frames), found(bases);
        for (float& weight : truth) weight = static_cast<float>(random.bell());
        for (uint32_t t = 0; t < frames; ++t)
            for (uint32_t c = 0; c < bases; ++c) values[t] += basis[t * bases + c] * truth[c];
        training::BasisSolver(basis, frames, bases).solve(values.data(), found.data());
        for (uint32_t c = 0; c < bases; ++c) EXPECT_NEAR(found[c], truth[c], 1e-4) << frames << ' ' << bases;
    }
}

TEST(CourseSolver, ComesNearACourseOutsideTheSpan) {
    const std::vector<float> basis = voctree::hat_basis(9, 2);  // straight lines
    const std::vector<float> values = {0, 0, 0, 0, 1, 0, 0, 0, 0};
    std::vector<float> weights(2);
    training::BasisSolver(basis, 9, 2).solve(values.data(), weights.data());
    EXPECT_NEAR(weights[0], 1.0 / 9, 1e-4);  // the best line is the mean
    EXPECT_NEAR(weights[1], 1.0 / 9, 1e-4);
}

TEST(CourseSolver, ColumnsThatBecameAlikeShare) {
    const std::vector<float> basis = {1, 1, 1, 1, 1, 1}, values = {2, 2, 2};  // 3 frames × 2 equal columns
    std::vector<float> weights(2);
    training::BasisSolver(basis, 3, 2).solve(values.data(), weights.data());
    EXPECT_NEAR(weights[0], 1, 1e-3);
    EXPECT_NEAR(weights[1], 1, 1e-3);
}

}  // namespace
}  // namespace neuvv::test
