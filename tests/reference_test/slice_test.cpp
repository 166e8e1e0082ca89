#include "reference/slice.h"

#include <gtest/gtest.h>

#include "reference/sample.h"
#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

constexpr uint32_t kBases = 7;

std::vector<double> random_values(Random& random, uint32_t count, double size) {
    std::vector<double> values(count);
    for (double& v : values) v = random.uniform(-size, size);
    return values;
}

// A leaf, the rows of one time, and a random linear loss of the leaf's slice.
struct Leaf {
    uint32_t degree;
    LeafWeights weights;
    std::vector<double> row_a, row_b;
    double d_sigma;
    ShCoefficients d_k{};

    double loss() const {
        const LeafSlice s = slice(weights, row_a, row_b, degree);
        double sum = d_sigma * s.sigma;
        for (size_t c = 0; c < 3; ++c) {
            for (size_t i = 0; i < kMaxShCount; ++i) sum += d_k[c][i] * s.k[c][i];
        }
        return sum;
    }
    SliceGradient gradient() const { return slice_adjoint(weights, row_a, row_b, degree, d_sigma, d_k); }
};

Leaf random_leaf(Random& random, uint32_t degree, double density) {
    Leaf leaf;
    leaf.degree = degree;
    leaf.row_a = random_values(random, kBases, 1);
    leaf.row_b = random_values(random, kBases, 1);
    leaf.weights.sigma = random_values(random, kBases, 1);
    leaf.weights.gamma = random_values(random, kBases, 1);
    for (auto& channel : leaf.weights.hh) channel = random_values(random, hh_count(degree), 1);
    leaf.d_sigma = random.uniform(-1, 1);
    for (auto& channel : leaf.d_k) {
        for (uint32_t i = 0; i < sh_count(degree); ++i) channel[i] = random.uniform(-1, 1);
    }
    // Moves A_t·w^σ to `density`, away from the kink of relu.
    double dot = 0;
    for (size_t i = 1; i < kBases; ++i) dot += leaf.row_a[i] * leaf.weights.sigma[i];
    leaf.row_a[0] = 0.8;
    leaf.weights.sigma[0] = (density - dot) / leaf.row_a[0];
    return leaf;
}

void check_gradient(Leaf& leaf, std::vector<double>& values, const std::vector<double>& gradient, const char* name) {
    ASSERT_EQ(values.size(), gradient.size()) << name;
    for (size_t i = 0; i < values.size(); ++i) {
        EXPECT_LT(gradient_error(gradient[i], values[i], [&] { return leaf.loss(); }), 1e-6) << name << " " << i;
    }
}

TEST(Slice, FrameRowsInterpolateAndClamp) {
    const std::vector<float> basis = {1, 2, 3, 4, 5, 6};  // 3 frames of 2
    EXPECT_EQ(basis_row(basis, 2, frame_rows(1, 3)), (std::vector<double>{3, 4}));
    EXPECT_EQ(basis_row(basis, 2, frame_rows(0.25, 3)), (std::vector<double>{1.5, 2.5}));
    EXPECT_EQ(basis_row(basis, 2, frame_rows(-3, 3)), (std::vector<double>{1, 2}));
    EXPECT_EQ(basis_row(basis, 2, frame_rows(2, 3)), (std::vector<double>{5, 6}));
    EXPECT_EQ(basis_row(basis, 2, frame_rows(99, 3)), (std::vector<double>{5, 6}));
    EXPECT_EQ(basis_row(basis, 2, frame_rows(0.5, 1)), (std::vector<double>{1, 2}));
}

TEST(Slice, ReadsALeafInFileOrder) {
    voctree::VOctree tree;
    tree.bases = 2;
    tree.hh_degree = 1;
    tree.leaf_count = 2;
    for (uint32_t i = 0; i < 2 * tree.weights_per_leaf(); ++i) tree.weights.push_back(static_cast<float>(i));
    const LeafWeights weights = leaf_weights(tree, 1);
    EXPECT_EQ(weights.sigma, (std::vector<double>{19, 20}));
    EXPECT_EQ(weights.gamma, (std::vector<double>{21, 22}));
    EXPECT_EQ(weights.hh[0], (std::vector<double>{23, 24, 25, 26, 27}));
    EXPECT_EQ(weights.hh[2], (std::vector<double>{33, 34, 35, 36, 37}));
}

TEST(Slice, DensityIsReluAndGammaStaysOnItsInterval) {
    Random random(5);
    for (const double density : {-2.0, 3.0}) {
        const Leaf leaf = random_leaf(random, 2, density);
        const LeafSlice s = slice(leaf.weights, leaf.row_a, leaf.row_b, 2);
        EXPECT_NEAR(s.sigma, density > 0 ? density : 0, 1e-12);
        EXPECT_GT(s.gamma, 0);
        EXPECT_LT(s.gamma, std::numbers::pi);
    }
}

// Errata 7: the colour from the slice is that from all HH weights.
TEST(Slice, EqualsDirectEvaluation) {
    Random random(6);
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        for (int i = 0; i < 100; ++i) {
            const Leaf leaf = random_leaf(random, degree, 1);
            const LeafSlice s = slice(leaf.weights, leaf.row_a, leaf.row_b, degree);
            const glm::dvec3 d = random_direction(random);
            const glm::dvec3 sliced = sample_colour(s, degree, d);
            const glm::dvec3 direct = sample_colour_direct(leaf.weights, s.gamma, degree, d);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(sliced[c], direct[c], 1e-13);
        }
    }
}

TEST(Slice, AdjointIsTheGradientOfEveryParameterClass) {
    Random random(7);
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        for (int i = 0; i < 10; ++i) {
            Leaf leaf = random_leaf(random, degree, random.uniform(0.1, 2));
            const SliceGradient g = leaf.gradient();
            check_gradient(leaf, leaf.weights.sigma, g.weights.sigma, "w^sigma");
            check_gradient(leaf, leaf.weights.gamma, g.weights.gamma, "w^gamma");
            for (size_t c = 0; c < 3; ++c) check_gradient(leaf, leaf.weights.hh[c], g.weights.hh[c], "w^HH");
            check_gradient(leaf, leaf.row_a, g.row_a, "A_t");
            check_gradient(leaf, leaf.row_b, g.row_b, "B_t");
        }
    }
}

TEST(Slice, NoDensityGradientAtOrBelowZero) {
    Random random(8);
    Leaf leaf = random_leaf(random, 2, -0.5);
    for (const bool at_kink : {false, true}) {
        if (at_kink) std::fill(leaf.weights.sigma.begin(), leaf.weights.sigma.end(), 0.0);
        const SliceGradient g = leaf.gradient();
        for (const double d : g.weights.sigma) EXPECT_EQ(d, 0);
        for (const double d : g.row_a) EXPECT_EQ(d, 0);
        EXPECT_NE(g.weights.gamma[0], 0);
    }
}

TEST(Sample, AdjointIsTheGradient) {
    Random random(9);
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const Leaf leaf = random_leaf(random, degree, 1);
        LeafSlice s = slice(leaf.weights, leaf.row_a, leaf.row_b, degree);
        const glm::dvec3 d = random_direction(random);
        const glm::dvec3 d_colour = random_point(random, -1, 1);
        const ShCoefficients g = sample_colour_adjoint(s, degree, d, d_colour);
        const auto loss = [&] { return glm::dot(d_colour, sample_colour(s, degree, d)); };
        for (size_t c = 0; c < 3; ++c) {
            for (size_t i = 0; i < sh_count(degree); ++i) EXPECT_LT(gradient_error(g[c][i], s.k[c][i], loss), 1e-6);
            for (size_t i = sh_count(degree); i < kMaxShCount; ++i) EXPECT_EQ(g[c][i], 0);
        }
    }
}

TEST(Sample, NoCoefficientsGiveCentreGrey) {
    const glm::dvec3 colour = sample_colour(LeafSlice{}, 3, {1, 0, 0});
    for (int c = 0; c < 3; ++c) EXPECT_EQ(colour[c], 0.5);
}

}  // namespace
}  // namespace neuvv::reference::test
