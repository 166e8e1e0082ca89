// Tests the reference of loss, optimiser and camera rays.
#include <gtest/gtest.h>

#include "reference/adam.h"
#include "reference/camera.h"
#include "reference/loss.h"
#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

// A patch away from all kinks: |P−I| is large, and each pixel is clearly on one side of the joint of the transfer
// function.
Patch random_patch(Random& random, bool dark) {
    Patch patch;
    for (PatchPixel& p : patch) {
        p.background = dark ? glm::dvec3(0.001) : random_point(random, 0.1, 1);
        p.alpha = random.uniform(0, 1);
        p.true_alpha = p.alpha;
        p.colour = dark ? random_point(random, 0.0005, 0.0015) : random_point(random, 0.1, 0.5);
        for (int c = 0; c < 3; ++c) p.true_colour[c] = p.colour[c] + (random.below(2) == 0 ? 0.3 : -0.09);
    }
    return patch;
}

TEST(Loss, TransferFunctionMatchesItsDefinition) {
    EXPECT_EQ(display_value(0), 0);
    EXPECT_EQ(display_value(-1), 0);
    EXPECT_NEAR(display_value(0.001), 0.01292, 1e-15);
    EXPECT_NEAR(display_value(0.21404114), 0.5, 1e-7);
    EXPECT_NEAR(display_value(1), 1, 1e-15);
    EXPECT_GT(display_value(2), 1.3);
    EXPECT_EQ(display_slope(0), 12.92);
    EXPECT_EQ(display_slope(-0.1), 0);
    for (double x : {0.001, 0.01, 0.3, 1.0, 1.7}) {
        EXPECT_LT(gradient_error(
                      display_slope(x), x, [&] { return display_value(x); }, 1e-4),
                  1e-6);
    }
}

TEST(Loss, OneWrongPixelByHand) {
    Patch patch;  // black on black
    for (PatchPixel& p : patch) p.alpha = p.true_alpha = 1;
    patch[2 * kPatchSide + 3].colour.y = 1;  // display value 1: e = 1 here alone
    const PatchLoss loss = patch_loss(patch, 64);
    EXPECT_NEAR(loss.rgb, 1.0 / 64, 1e-15);
    EXPECT_NEAR(loss.grad, 4.0 / 64, 1e-15);  // from the left, from above, to the right, to below
    EXPECT_NEAR(loss.total(0.1), 1.4 / 64, 1e-15);
}

TEST(Loss, CornersHaveNoNeighboursOutsideThePatch) {
    Patch patch;
    patch[kPatchPixels - 1].colour.x = 1;
    EXPECT_NEAR(patch_loss(patch, 1).grad, 2, 1e-14);
    Patch first;
    first[0].colour.x = 1;
    EXPECT_NEAR(patch_loss(first, 1).grad, 2, 1e-14);
}

TEST(Loss, BackgroundShowsThroughBothSides) {
    Random random(1);
    Patch patch = random_patch(random, false);
    for (PatchPixel& p : patch) {
        p.true_colour = p.colour;
        p.true_alpha = p.alpha;
    }
    EXPECT_EQ(patch_loss(patch, 64).total(1), 0);
    patch[5].alpha += 0.2;
    EXPECT_GT(patch_loss(patch, 64).rgb, 1e-6);
    patch[5].background = glm::dvec3(0);
    EXPECT_EQ(patch_loss(patch, 64).total(1), 0);
}

TEST(Loss, AdjointIsTheGradient) {
    Random random(2);
    for (const bool dark : {false, true}) {
        for (const double lambda : {0.0, 0.1, 3.0}) {
            Patch patch = random_patch(random, dark);
            const auto gradient = patch_loss_adjoint(patch, lambda, 256);
            const auto loss = [&] { return patch_loss(patch, 256).total(lambda); };
            for (size_t i = 0; i < kPatchPixels; ++i) {
                for (int c = 0; c < 3; ++c) {
                    EXPECT_LT(gradient_error(gradient[i].colour[c], patch[i].colour[c], loss, 1e-4), 1e-6) << i;
                }
                EXPECT_LT(gradient_error(gradient[i].alpha, patch[i].alpha, loss, 1e-4), 1e-6) << i;
            }
        }
    }
}

TEST(Loss, AdjointOfACamerasColourIsTheGradient) {
    Random random(7);
    Patch patch = random_patch(random, false);
    CameraColour camera{glm::dmat3(1.1, 0.03, -0.02, 0.04, 0.95, 0.01, -0.03, 0.02, 1.02), {0.01, 0.02, -0.01}};
    const auto loss = [&] { return patch_loss(seen_by(camera, patch), 256).total(0.1); };
    const ColourGradient gradient =
        seen_by_adjoint(camera, patch, patch_loss_adjoint(seen_by(camera, patch), 0.1, 256));
    for (size_t i = 0; i < kPatchPixels; ++i) {
        for (int c = 0; c < 3; ++c)
            EXPECT_LT(gradient_error(gradient.pixels[i].colour[c], patch[i].colour[c], loss, 1e-4), 1e-6) << i;
        EXPECT_LT(gradient_error(gradient.pixels[i].alpha, patch[i].alpha, loss, 1e-4), 1e-6) << i;
    }
    for (int c = 0; c < 3; ++c) {
        for (int row = 0; row < 3; ++row)
            EXPECT_LT(gradient_error(gradient.camera.matrix[c][row], camera.matrix[c][row], loss, 1e-4), 1e-6);
        EXPECT_LT(gradient_error(gradient.camera.offset[c], camera.offset[c], loss, 1e-4), 1e-6);
    }
}

TEST(Loss, APerfectPixelPullsNowhere) {
    Random random(3);
    Patch patch = random_patch(random, false);
    patch[9].true_colour = patch[9].colour;
    const auto gradient = patch_loss_adjoint(patch, 0.1, 64);
    // Here |P−I| = 0, whose subgradient is 0 whatever its neighbours' errors are.
    EXPECT_EQ(gradient[9].colour, glm::dvec3(0));
    EXPECT_EQ(gradient[9].alpha, 0);
    EXPECT_NE(gradient[10].colour.x, 0);
}

TEST(Adam, FirstStepIsTheLearningRate) {
    const AdamSettings settings;
    AdamElement up{1, 0, 0}, down{1, 0, 0};
    adam_update(up, -1e-3, settings, adam_bias(0.9, 1), adam_bias(0.999, 1));
    adam_update(down, 50, settings, adam_bias(0.9, 1), adam_bias(0.999, 1));
    EXPECT_NEAR(up.weight, 1 + settings.learning_rate, 1e-6);
    EXPECT_NEAR(down.weight, 1 - settings.learning_rate, 1e-6);
}

TEST(Adam, TwoStepsByHand) {
    AdamSettings settings{0.1, 0.5, 0.75, 0};
    AdamElement e{0, 0, 0};
    adam_update(e, 2, settings, adam_bias(0.5, 1), adam_bias(0.75, 1));
    EXPECT_NEAR(e.m, 1, 1e-15);
    EXPECT_NEAR(e.v, 1, 1e-15);
    EXPECT_NEAR(e.weight, -0.1, 1e-15);
    adam_update(e, -4, settings, adam_bias(0.5, 2), adam_bias(0.75, 2));
    EXPECT_NEAR(e.m, -1.5, 1e-15);
    EXPECT_NEAR(e.v, 4.75, 1e-15);
    EXPECT_NEAR(e.weight, -0.1 + 0.1 * 2 / std::sqrt(4.75 / 0.4375), 1e-15);
}

TEST(Adam, ZeroGradientTouchesNothing) {
    AdamElement e{3, 0.5, 0.25};
    adam_update(e, 0, {}, adam_bias(0.9, 7), adam_bias(0.999, 7));
    EXPECT_EQ(e.weight, 3);
    EXPECT_EQ(e.m, 0.5);
    EXPECT_EQ(e.v, 0.25);
}

TEST(Camera, LooksAlongMinusZWithYUp) {
    stage::Camera camera;
    camera.width = camera.height = 4;
    camera.fx = camera.fy = 2;
    camera.cx = camera.cy = 2;
    camera.world_from_camera[3] = glm::dvec4(1, 2, 3, 1);
    const Ray ray = camera_ray(camera, 0, 0);  // top left pixel, centre at (0.5, 0.5)
    EXPECT_EQ(ray.origin, glm::dvec3(1, 2, 3));
    const glm::dvec3 expected = glm::normalize(glm::dvec3(-0.75, 0.75, -1));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ray.direction[c], expected[c], 1e-15);
    EXPECT_NEAR(camera_ray(camera, 1.5, 1.5).direction.z, -1, 1e-15);
}

TEST(Camera, PoseTurnsTheRay) {
    stage::Camera camera;
    camera.world_from_camera = glm::dmat4({0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1});
    const glm::dvec3 d = camera_ray(camera, -0.5, -0.5).direction;  // the principal ray: −Z of the camera is −X here
    EXPECT_NEAR(d.x, -1, 1e-15);
    EXPECT_NEAR(d.z, 0, 1e-15);
}

}  // namespace
}  // namespace neuvv::reference::test
