// Tests the reference of Ψ: its encoding by hand, its adjoint against differences, its importance sampling.
#include "reference/psi.h"

#include <gtest/gtest.h>

#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

PsiLayer random_layer(Random& random, size_t inputs, size_t outputs) {
    PsiLayer layer{inputs, outputs, std::vector<double>((inputs + 1) * outputs)};
    for (double& value : layer.numbers) value = random.bell() / std::sqrt(static_cast<double>(inputs));
    return layer;
}

Psi random_psi(Random& random) {
    Psi psi{.frequencies = 3, .bases = 4, .hh_degree = 2, .density = 2.5, .hidden = {}, .output = {}};
    psi.hidden = {random_layer(random, 21, 10), random_layer(random, 10, 10)};
    psi.output = random_layer(random, 10, 2 * psi.bases + 3 * hh_count(psi.hh_degree));
    return psi;
}

std::vector<double> random_row(Random& random, size_t count) {
    std::vector<double> row(count);
    for (double& value : row) value = random.bell();
    return row;
}

TEST(Psi, EncodingByHand) {
    const std::vector<double> features = psi_encode({0.25, -0.5, 1}, 2);
    const double root = std::numbers::sqrt2 / 2;
    const std::vector<double> truth = {0.25, -0.5, 1, root, -1, 0, root, 0, -1, 1, 0, 0, 0, -1, 1};
    ASSERT_EQ(features.size(), truth.size());
    for (size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(features[i], truth[i], 1e-15) << i;
}

TEST(Psi, ALayerByHand) {
    const PsiLayer layer{2, 2, {1, 2, 3, 4, 0.5, -0.5}};  // W = (1 2; 3 4), b = (½, −½)
    EXPECT_EQ(layer_forward(layer, {10, 100}), (std::vector<double>{310.5, 419.5}));
    PsiLayer gradient{2, 2, std::vector<double>(6)};
    EXPECT_EQ(layer_adjoint(layer, {10, 100}, {1, -1}, gradient), (std::vector<double>{-1, -1}));
    EXPECT_EQ(gradient.numbers, (std::vector<double>{10, -10, 100, -100, 1, -1}));
}

// Every parameter of a small network, by class.
TEST(Psi, SampleAdjointIsTheDerivative) {
    Random random(3);
    Psi psi = random_psi(random);
    std::vector<double> row_a = random_row(random, psi.bases), row_b = random_row(random, psi.bases);
    glm::dvec3 x, direction;
    do {
        x = random_point(random, -1, 1);
        direction = random_direction(random);
    } while (psi_sample(psi, row_a, row_b, x, direction).sigma < 0.1);
    const glm::dvec3 colour_weight = random_point(random, -1, 1);
    const auto loss = [&] {
        const PsiSample sample = psi_sample(psi, row_a, row_b, x, direction);
        return 0.7 * sample.sigma + glm::dot(colour_weight, sample.colour);
    };
    PsiGradient gradient = psi_gradient_begin(psi);
    psi_sample_adjoint(psi, row_a, row_b, x, direction, 0.7, colour_weight, gradient);
    const auto check = [&](const char* name, std::vector<double>& numbers, const std::vector<double>& d) {
        ASSERT_EQ(numbers.size(), d.size());
        size_t live = 0;
        for (size_t i = 0; i < d.size(); ++i) {
            EXPECT_LT(gradient_error(d[i], numbers[i], loss, 1e-5), 1e-6) << name << ' ' << i;
            live += d[i] != 0 ? 1 : 0;
        }
        EXPECT_GT(live, d.size() / 5) << name;
    };
    check("hidden 0", psi.hidden[0].numbers, gradient.network.hidden[0].numbers);
    check("hidden 1", psi.hidden[1].numbers, gradient.network.hidden[1].numbers);
    check("output", psi.output.numbers, gradient.network.output.numbers);
    check("row A", row_a, gradient.row_a);
    check("row B", row_b, gradient.row_b);
}

// Where relu makes a sample's density 0, all gradients are 0.
TEST(Psi, EmptySpaceHasNoDensityGradient) {
    Random random(4);
    Psi psi = random_psi(random);
    const std::vector<double> row_a(psi.bases, 1), row_b = random_row(random, psi.bases);
    double* bias = &psi.output.numbers[psi.output.inputs * psi.output.outputs];
    for (size_t c = 0; c < psi.bases; ++c) bias[c] = -100;
    PsiGradient gradient = psi_gradient_begin(psi);
    psi_sample_adjoint(psi, row_a, row_b, {0.1, 0.2, 0.3}, {0, 0, 1}, 1, glm::dvec3(0), gradient);
    for (const double d : gradient.network.output.numbers) EXPECT_EQ(d, 0);
    for (const double d : gradient.row_a) EXPECT_EQ(d, 0);

    // With `revival`, the density may grow from 0, or must not fall further.
    const auto bias_gradient = [&](double d_sigma, double revival) {
        PsiGradient d = psi_gradient_begin(psi);
        psi_sample_adjoint(psi, row_a, row_b, {0.1, 0.2, 0.3}, {0, 0, 1}, d_sigma, glm::dvec3(0), d, revival);
        return d.network.output.numbers[psi.output.inputs * psi.output.outputs];
    };
    EXPECT_EQ(bias_gradient(-1, 0), -psi.density);
    EXPECT_EQ(bias_gradient(1, 10), 0);
    EXPECT_EQ(bias_gradient(1, 1e4), psi.density);
}

TEST(Psi, ImportanceFollowsTheWeights) {
    // All density is in the third quarter: with a fifth of the importance uniform, 85 % of the segments are there.
    const std::vector<double> edges = importance_edges({0, 0, 1e3, 0}, 2, 6, 100, 0.2);
    ASSERT_EQ(edges.size(), 101u);
    EXPECT_EQ(edges.front(), 2);
    EXPECT_EQ(edges.back(), 6);
    const auto inside =
        std::count_if(edges.begin(), edges.end(), [](double t) { return t >= 4 - 1e-9 && t <= 5 + 1e-9; });
    EXPECT_NEAR(static_cast<double>(inside), 86, 1);
    for (size_t i = 1; i < edges.size(); ++i) EXPECT_GT(edges[i], edges[i - 1]);
    const std::vector<double> empty = importance_edges({0, 0, 0, 0}, 2, 6, 8, 0.2);
    for (size_t i = 0; i < empty.size(); ++i) EXPECT_NEAR(empty[i], 2 + 0.5 * static_cast<double>(i), 1e-12);
}

}  // namespace
}  // namespace neuvv::reference::test
