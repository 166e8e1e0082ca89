// loss.comp against the reference: the sums, and ∂L/∂(C, α) by central differences.
#include "training/step/loss.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include "gradient/agreement.h"
#include "reference/loss.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "training/step/camera_colour.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kTiles = 3;
constexpr double kLambda = 0.1;

struct LossScene {
    std::vector<glm::vec4> radiance, target, background;  // per ray
    std::vector<CameraColour> colours;                    // per tile; none: all cameras agree
};

// Tile 0 is whole, tile 1 lies at the right edge of an image, tile 2 at its bottom right corner. No error is near the
// kink |P−I| = 0. A third of the pixels are dark, on the linear part of sRGB. A pixel has samples² rays.
LossScene random_loss_scene(uint64_t seed, uint32_t samples = 1) {
    Random random(seed);
    const auto between = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    LossScene scene;
    for (uint32_t i = 0; i < kTiles * kTilePixels; ++i) {
        const uint32_t tile = i / kTilePixels, x = i % kTile, y = i % kTilePixels / kTile;
        const bool inside = tile == 0 || (x < 4 && (tile == 1 || y < 4));
        const uint32_t first = i - x % samples - y % samples * kTile;  // the first ray of this ray's pixel
        const bool dark = first % 3 == 0;
        const float alpha = between(0.1, 0.95), true_alpha = between(0, 1);
        glm::vec4 seen(0, 0, 0, alpha), truth(0, 0, 0, true_alpha), behind(0);
        for (int c = 0; c < 3; ++c) {
            behind[c] = dark ? between(1e-4, 1e-3) : between(0.05, 0.9);
            seen[c] = dark ? between(1e-4, 1e-3) : alpha * between(0.1, 0.9);
            truth[c] = true_alpha * between(0.1, 0.9);
        }
        if (!inside) truth = glm::vec4(0.3f, 0.2f, 0.1f, -1);
        scene.radiance.push_back(seen);
        scene.target.push_back(first == i ? truth : glm::vec4(scene.target[first]));
        scene.background.push_back(first == i ? behind : glm::vec4(scene.background[first]));
    }
    return scene;
}

reference::Patch patch_of(const LossScene& scene, uint32_t tile) {
    reference::Patch patch;
    for (uint32_t i = 0; i < kTilePixels; ++i) {
        const size_t ray = size_t{tile} * kTilePixels + i;
        patch[i] = {glm::dvec3(scene.radiance[ray]),   scene.radiance[ray].a,
                    glm::dvec3(scene.target[ray]),     scene.target[ray].a,
                    glm::dvec3(scene.background[ray]), scene.target[ray].a >= 0};
    }
    return patch;
}

struct DeviceLoss {
    std::vector<glm::vec4> adjoint, sums;
    std::vector<CameraColour> colour_gradients;
};

DeviceLoss loss_on(const gpu::Device& device, const LossScene& scene, uint32_t samples = 1) {
    const render::RayBatch rays(device, 1, kTiles);
    const training::LossBatch batch(device, kTiles);
    const training::Loss loss(device, rays, batch);
    const uint64_t bytes = scene.radiance.size() * sizeof(glm::vec4);
    gpu::upload(device, rays.radiance, scene.radiance.data(), bytes);
    for (size_t i = 0; i < scene.target.size(); ++i) {
        glm::vec4 target = scene.target[i];
        if (!scene.colours.empty() && target.a >= 0)
            target = glm::vec4(training::seen(training::inverse(scene.colours[i / kTilePixels]), target), target.a);
        batch.target.as<glm::vec4>()[i] = target;
    }
    std::copy(scene.colours.begin(), scene.colours.end(), batch.colours.as<CameraColour>());
    std::copy(scene.background.begin(), scene.background.end(), batch.background.as<glm::vec4>());
    LossWeights weights{};
    weights.grad = static_cast<float>(kLambda);
    gpu::run_once(device, "loss", [&](gpu::Commands& commands) {
        training::record_loss(commands, loss, kTiles, weights, samples, !scene.colours.empty());
    });
    DeviceLoss result{std::vector<glm::vec4>(scene.radiance.size()), std::vector<glm::vec4>(kTiles),
                      std::vector<CameraColour>(kTiles)};
    gpu::download(device, batch.adjoint, result.adjoint.data(), bytes);
    gpu::download(device, batch.colour_gradients, result.colour_gradients.data(), kTiles * sizeof(CameraColour));
    gpu::download(device, batch.sums, result.sums.data(), kTiles * sizeof(glm::vec4));
    return result;
}

double total_loss(const reference::Patch& patch, uint32_t samples) {
    return reference::patch_loss(reference::pixel_means(patch, samples), 1).total(kLambda);
}

double by_central_difference(reference::Patch& patch, double& number, uint32_t samples) {
    constexpr double kSmallNudge = 1e-7;  // much smaller than the distance to any kink
    const double before = number;
    number = before + kSmallNudge;
    const double above = total_loss(patch, samples);
    number = before - kSmallNudge;
    const double below = total_loss(patch, samples);
    number = before;
    return (above - below) / (2 * kSmallNudge);
}

using LossTest = GpuTest;

class LossOfSamples : public GpuTest, public ::testing::WithParamInterface<uint32_t> {};

TEST_P(LossOfSamples, SumsAreThoseOfTheReference) {
    const LossScene scene = random_loss_scene(1, GetParam());
    const DeviceLoss found = loss_on(device(), scene, GetParam());
    const float rays[kTiles] = {64, 32, 16};
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
        const reference::PatchLoss truth =
            reference::patch_loss(reference::pixel_means(patch_of(scene, tile), GetParam()), 1);
        EXPECT_NEAR(found.sums[tile].x, truth.rgb, 1e-5 * truth.rgb);
        EXPECT_NEAR(found.sums[tile].y, truth.grad, 1e-5 * truth.grad);
        EXPECT_EQ(found.sums[tile].z, rays[tile] / static_cast<float>(GetParam() * GetParam()));
    }
}

TEST_P(LossOfSamples, AdjointIsTheDerivative) {
    const LossScene scene = random_loss_scene(2, GetParam());
    const DeviceLoss found = loss_on(device(), scene, GetParam());
    std::vector<GradientPair> colours, alphas;
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
        reference::Patch patch = patch_of(scene, tile);
        for (uint32_t i = 0; i < kTilePixels; ++i) {
            const glm::vec4 adjoint = found.adjoint[size_t{tile} * kTilePixels + i];
            if (!patch[i].inside) {
                EXPECT_EQ(adjoint, glm::vec4(0));
                continue;
            }
            for (int c = 0; c < 3; ++c)
                colours.push_back({adjoint[c], by_central_difference(patch, patch[i].colour[c], GetParam())});
            alphas.push_back({adjoint.a, by_central_difference(patch, patch[i].alpha, GetParam())});
        }
    }
    expect_gradients("colour", colours);
    expect_gradients("alpha", alphas);
}

// A camera with a gain, some mixing of channels and an offset. All add light, so that no colour is negative.
CameraColour random_colour(Random& random) {
    CameraColour colour = training::kNeutralColour;
    for (glm::vec4& row : colour.rows)
        for (int i = 0; i < 4; ++i) row[i] += static_cast<float>(random.uniform(0, 0.04));
    return colour;
}

reference::CameraColour exact(const CameraColour& colour) {
    reference::CameraColour result;
    for (int row = 0; row < 3; ++row) {
        for (int c = 0; c < 3; ++c) result.matrix[c][row] = double{colour.rows[row][c]};
        result.offset[row] = double{colour.rows[row].a};
    }
    return result;
}

TEST_P(LossOfSamples, AdjointThroughACamerasColourIsTheDerivative) {
    LossScene scene = random_loss_scene(5, GetParam());
    Random random(6);
    for (uint32_t tile = 0; tile < kTiles; ++tile) scene.colours.push_back(random_colour(random));
    const DeviceLoss found = loss_on(device(), scene, GetParam());
    std::vector<GradientPair> rays, cameras;
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
        const reference::CameraColour camera = exact(scene.colours[tile]);
        const reference::Patch patch = patch_of(scene, tile);
        reference::Patch pixels = reference::pixel_means(patch, GetParam());
        const reference::PatchLoss truth = reference::patch_loss(reference::seen_by(camera, pixels), 1);
        EXPECT_NEAR(found.sums[tile].x, truth.rgb, 1e-4 * truth.rgb);
        const reference::ColourGradient gradient = reference::seen_by_adjoint(
            camera, pixels, reference::patch_loss_adjoint(reference::seen_by(camera, pixels), kLambda, 1));
        for (int row = 0; row < 3; ++row) {
            const glm::vec4 sums = found.colour_gradients[tile].rows[row];
            for (int c = 0; c < 3; ++c) cameras.push_back({sums[c], gradient.camera.matrix[c][row]});
            cameras.push_back({sums.a, gradient.camera.offset[row]});
        }
        for (uint32_t i = 0; i < kTilePixels; ++i) {
            if (!patch[i].inside) continue;
            const uint32_t pixel = i / kTile / GetParam() * kTile + i % kTile / GetParam();
            const reference::PixelGradient& d = gradient.pixels[pixel];
            const glm::vec4 adjoint = found.adjoint[size_t{tile} * kTilePixels + i];
            const double rays_a_pixel = GetParam() * GetParam();
            for (int c = 0; c < 3; ++c) rays.push_back({adjoint[c] * rays_a_pixel, d.colour[c]});
            rays.push_back({adjoint.a * rays_a_pixel, d.alpha});
        }
    }
    expect_gradients("rays", rays);
    expect_gradients("cameras", cameras);
}

INSTANTIATE_TEST_SUITE_P(RaysAPixel, LossOfSamples, ::testing::Values(1, 2, 4));

TEST_F(LossTest, NeighboursBeyondTheImageChangeNothing) {
    LossScene scene = random_loss_scene(3);
    const DeviceLoss before = loss_on(device(), scene);
    for (size_t i = 0; i < scene.target.size(); ++i)
        if (scene.target[i].a < 0) scene.radiance[i] = glm::vec4(7);
    const DeviceLoss after = loss_on(device(), scene);
    EXPECT_EQ(before.adjoint, after.adjoint);
    EXPECT_EQ(before.sums, after.sums);
}

// At 0, |P−I| has the subgradient 0.
TEST_F(LossTest, ARightPixelPullsNowhere) {
    LossScene scene = random_loss_scene(4);
    scene.target[9] = scene.radiance[9];
    const DeviceLoss found = loss_on(device(), scene);
    EXPECT_EQ(found.adjoint[9], glm::vec4(0));
    EXPECT_NE(found.adjoint[10], glm::vec4(0));
}

}  // namespace
}  // namespace neuvv::test
