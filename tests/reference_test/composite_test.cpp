#include "reference/composite.h"

#include <gtest/gtest.h>

#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

std::vector<Sample> random_samples(Random& random, size_t count) {
    std::vector<Sample> samples;
    double t = 1;
    for (size_t i = 0; i < count; ++i) {
        const double delta = random.uniform(0.05, 0.5);
        samples.push_back({random.uniform(0.1, 3), random_point(random, 0, 1), delta, t + delta / 2});
        t += delta;
    }
    return samples;
}

TEST(Composite, EmptyRayIsTransparentAndInfinitelyFar) {
    const RayResult none = composite({});
    EXPECT_EQ(none.alpha, 0);
    EXPECT_EQ(none.colour, glm::dvec3(0));
    EXPECT_TRUE(std::isinf(none.depth_m));
    const RayResult vacuum = composite({{0, glm::dvec3(1), 2, 5}});
    EXPECT_EQ(vacuum.alpha, 0);
    EXPECT_EQ(vacuum.colour, glm::dvec3(0));
    EXPECT_TRUE(std::isinf(vacuum.depth_m));
}

TEST(Composite, OneSampleByHand) {
    const RayResult r = composite({{std::log(4.0), glm::dvec3(1, 0.5, 0), 0.5, 3}});  // T = 4^(−1/2)
    EXPECT_NEAR(r.alpha, 0.5, 1e-15);
    EXPECT_NEAR(r.colour.x, 0.5, 1e-15);
    EXPECT_NEAR(r.colour.y, 0.25, 1e-15);
    EXPECT_NEAR(r.depth_m, 3, 1e-14);
}

TEST(Composite, AlphaIsOneMinusTheProductOfTransmittances) {
    Random random(1);
    for (int i = 0; i < 50; ++i) {
        std::vector<Sample> samples = random_samples(random, 1 + random.below(20));
        double transmittance = 1;
        for (Sample& s : samples) {
            transmittance *= std::exp(-s.sigma * s.delta_m);
            s.colour = glm::dvec3(1);
        }
        const RayResult r = composite(samples);
        EXPECT_NEAR(r.alpha, 1 - transmittance, 1e-13);
        EXPECT_NEAR(r.colour.y, r.alpha, 1e-13);  // a white ray's colour is its alpha
        EXPECT_GE(r.depth_m, samples.front().z_m - 1e-12);
        EXPECT_LE(r.depth_m, samples.back().z_m + 1e-12);
    }
}

TEST(Composite, SplittingASegmentChangesNothingButItsDepth) {
    const Sample whole{1.7, glm::dvec3(0.2, 0.4, 0.9), 0.6, 2.3};
    Sample near = whole, far = whole;
    near.delta_m = 0.2;
    far.delta_m = 0.4;
    const RayResult a = composite({whole});
    const RayResult b = composite({near, far});
    EXPECT_NEAR(a.alpha, b.alpha, 1e-15);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.colour[c], b.colour[c], 1e-15);
}

TEST(Composite, StopsAfterTheSampleThatPassesTheThreshold) {
    const Sample half{std::log(2.0), glm::dvec3(1), 1, 1};
    EXPECT_NEAR(composite({half, half, half, half}, 0.3).alpha, 0.75, 1e-15);
    EXPECT_NEAR(composite({half, half, half, half}, 0).alpha, 0.9375, 1e-15);
    const auto gradient = composite_adjoint({half, half, half, half}, glm::dvec3(1), 1, 0.3);
    ASSERT_EQ(gradient.size(), 4u);
    EXPECT_NE(gradient[1].sigma, 0);
    EXPECT_EQ(gradient[2].sigma, 0);
    EXPECT_EQ(gradient[3].colour, glm::dvec3(0));
}

TEST(Composite, AdjointIsTheGradient) {
    Random random(2);
    for (int i = 0; i < 20; ++i) {
        std::vector<Sample> samples = random_samples(random, 1 + random.below(12));
        const glm::dvec3 d_colour = random_point(random, -1, 1);
        const double d_alpha = random.uniform(-1, 1);
        const double stop = i % 2 == 0 ? 0 : 0.5;
        const auto loss = [&] {
            const RayResult r = composite(samples, stop);
            return glm::dot(d_colour, r.colour) + d_alpha * r.alpha;
        };
        const auto gradient = composite_adjoint(samples, d_colour, d_alpha, stop);
        for (size_t j = 0; j < samples.size(); ++j) {
            // The step is short, so that no perturbation changes which sample is the last.
            EXPECT_LT(gradient_error(gradient[j].sigma, samples[j].sigma, loss, 1e-4), 1e-6) << j;
            for (int c = 0; c < 3; ++c) {
                EXPECT_LT(gradient_error(gradient[j].colour[c], samples[j].colour[c], loss, 1e-4), 1e-6) << j;
            }
        }
    }
}

}  // namespace
}  // namespace neuvv::reference::test
