// Resolve: rays to an 8-bit sRGB image.
#include "render/rays/resolve.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "media/image.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

// Rays in tile order, as the passes before resolve write them.
struct Rays {
    uint32_t width, height;
    std::vector<glm::vec4> radiance;
    std::vector<float> depth;

    Rays(uint32_t w, uint32_t h) : width(w), height(h) {
        radiance.resize(index_end());
        depth.resize(index_end());
    }
    uint32_t across() const { return (width + kTile - 1) / kTile; }
    size_t index_end() const { return size_t{across()} * ((height + kTile - 1) / kTile) * kTilePixels; }
    size_t index(uint32_t x, uint32_t y) const {
        return (size_t{y / kTile} * across() + x / kTile) * kTilePixels + y % kTile * kTile + x % kTile;
    }
};

media::Image resolve(const gpu::Device& device, const Rays& rays, const render::ResolveSettings& settings,
                     uint32_t samples = 1) {
    const render::RayBatch batch(device, 1, static_cast<uint32_t>(rays.index_end() / kTilePixels));
    media::Image image(rays.width / samples, rays.height / samples);
    const gpu::Buffer pixels(device, "image", image.rgba.size(), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT);
    gpu::upload(device, batch.radiance, rays.radiance.data(), rays.radiance.size() * sizeof(glm::vec4));
    gpu::upload(device, batch.depth, rays.depth.data(), rays.depth.size() * sizeof(float));
    const render::Resolver resolver(device, render::RaysPerPixel::kWhole, batch, pixels);
    gpu::run_once(device, "resolve", [&](gpu::Commands& commands) {
        render::record_resolve(commands, resolver, {rays.width / samples, rays.height / samples, samples}, settings);
    });
    gpu::download(device, pixels, image.rgba.data(), image.rgba.size());
    return image;
}

// The byte nearest to 255·value; a GPU's pow may err by 1/20 of a step where the value lies between two bytes.
void expect_byte(uint8_t byte, double value) {
    EXPECT_LE(std::abs(byte - 255 * std::clamp(value, 0.0, 1.0)), 0.55);
}

using ResolveTest = GpuTest;

TEST_F(ResolveTest, EverySrgbByteComesBack) {
    Rays rays(256, 1);
    for (uint32_t x = 0; x < 256; ++x)
        rays.radiance[rays.index(x, 0)] =
            glm::vec4(glm::vec3(static_cast<float>(media::linear_from_srgb(x / 255.0))), 1);
    const media::Image image = resolve(device(), rays, {});
    for (uint32_t x = 0; x < 256; ++x)
        for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(image.at(x, 0)[channel], x);
}

Rays random_rays() {
    Random random(7);
    Rays rays(37, 21);
    for (glm::vec4& ray : rays.radiance) {
        const double alpha = random.below(4) == 0 ? 0 : random.uniform();
        for (int channel = 0; channel < 3; ++channel)
            ray[channel] = static_cast<float>(alpha * random.uniform(0, 1.1));  // above 1: must be clamped
        ray.a = static_cast<float>(alpha);
    }
    return rays;
}

TEST_F(ResolveTest, AlphaIsStraightAndEmptyPixelsAreZero) {
    const Rays rays = random_rays();
    const media::Image image = resolve(device(), rays, {});
    for (uint32_t y = 0; y < rays.height; ++y)
        for (uint32_t x = 0; x < rays.width; ++x) {
            const glm::dvec4 ray(rays.radiance[rays.index(x, y)]);
            expect_byte(image.at(x, y)[3], ray.a);
            for (int channel = 0; channel < 3; ++channel)
                expect_byte(image.at(x, y)[channel],
                            ray.a > 0 ? media::srgb_from_linear(std::min(ray[channel] / ray.a, 1.0)) : 0);
        }
}

TEST_F(ResolveTest, BackgroundsBlendInLinearLight) {
    const Rays rays = random_rays();
    for (const float opacity : {1.0f, 0.5f}) {
        render::ResolveSettings settings;
        settings.background = {0.8f, 0.2f, 0.05f, opacity};
        const media::Image image = resolve(device(), rays, settings);
        for (uint32_t y = 0; y < rays.height; ++y)
            for (uint32_t x = 0; x < rays.width; ++x) {
                const glm::dvec4 ray(rays.radiance[rays.index(x, y)]), behind(settings.background);
                const double share = (1 - ray.a) * behind.a, alpha = ray.a + share;
                expect_byte(image.at(x, y)[3], alpha);
                for (int channel = 0; channel < 3; ++channel) {
                    const double linear = (ray[channel] + share * behind[channel]) / alpha;
                    expect_byte(image.at(x, y)[channel], media::srgb_from_linear(std::min(linear, 1.0)));
                }
            }
    }
}

TEST_F(ResolveTest, AlphaAndDepthAreGreyAndOpaque) {
    Rays rays = random_rays();
    Random random(8);
    rays.radiance[rays.index(3, 2)] = glm::vec4(0);
    for (size_t i = 0; i < rays.depth.size(); ++i)
        rays.depth[i] = rays.radiance[i].a > 0 ? static_cast<float>(random.uniform(0.5, 4.5))
                                               : std::numeric_limits<float>::infinity();  // as trace writes it
    render::ResolveSettings alpha, depth;
    alpha.show = render::Show::kAlpha;
    depth.show = render::Show::kDepth;
    depth.depth_near_m = 1;
    depth.depth_far_m = 4;
    const media::Image alpha_view = resolve(device(), rays, alpha), depth_view = resolve(device(), rays, depth);
    for (uint32_t y = 0; y < rays.height; ++y)
        for (uint32_t x = 0; x < rays.width; ++x) {
            const size_t ray = rays.index(x, y);
            for (int channel = 0; channel < 3; ++channel) {
                expect_byte(alpha_view.at(x, y)[channel], rays.radiance[ray].a);
                expect_byte(depth_view.at(x, y)[channel], (4.0 - rays.depth[ray]) / 3.0);  // near white, far black
            }
            EXPECT_EQ(alpha_view.at(x, y)[3], 255);
            EXPECT_EQ(depth_view.at(x, y)[3], 255);
        }
    EXPECT_EQ(depth_view.at(3, 2)[0], 0);
}

TEST_F(ResolveTest, APixelIsTheMeanOfItsRays) {
    Rays rays(3 * 11, 3 * 9);
    Random random(5);
    for (size_t i = 0; i < rays.radiance.size(); ++i) {
        const double alpha = random.below(3) == 0 ? 0 : random.uniform();
        rays.radiance[i] = glm::vec4(glm::vec3(static_cast<float>(alpha * random.uniform())), alpha);
        rays.depth[i] = alpha > 0 ? static_cast<float>(random.uniform(1, 4)) : std::numeric_limits<float>::infinity();
    }
    render::ResolveSettings depth_settings;
    depth_settings.show = render::Show::kDepth;
    depth_settings.depth_near_m = 1;
    depth_settings.depth_far_m = 4;
    const media::Image colour = resolve(device(), rays, {}, 3), depth = resolve(device(), rays, depth_settings, 3);
    for (uint32_t y = 0; y < 9; ++y)
        for (uint32_t x = 0; x < 11; ++x) {
            glm::dvec4 light(0);
            double metres = 0;
            for (uint32_t i = 0; i < 9; ++i) {
                const size_t ray = rays.index(3 * x + i % 3, 3 * y + i / 3);
                light += glm::dvec4(rays.radiance[ray]) / 9.0;
                if (rays.radiance[ray].a > 0) metres += double{rays.radiance[ray].a} * double{rays.depth[ray]} / 9.0;
            }
            expect_byte(colour.at(x, y)[3], light.a);
            for (int channel = 0; channel < 3; ++channel)
                expect_byte(colour.at(x, y)[channel], media::srgb_from_linear(light[channel] / light.a));
            expect_byte(depth.at(x, y)[0], (4 - metres / light.a) / 3);
        }
}

// More tiles than a dimension of a dispatch may have on many devices: their number is rounded up, and what is beyond
// the last image must not change.
TEST_F(ResolveTest, VeryManyTilesAreResolvedAndNothingElse) {
    constexpr uint32_t kWidth = 2402, kHeight = 1763, kUntouched = 0x12345678;
    const render::ViewLayout layout{kWidth, kHeight};
    const render::RayBatch batch(device(), 1, layout.ray_tiles());
    std::vector<glm::vec4> light(size_t{layout.ray_tiles()} * kTilePixels, glm::vec4(0, 0, 0, 1));
    light[0] = light.back() = glm::vec4(1);
    gpu::upload(device(), batch.radiance, light.data(), light.size() * sizeof(glm::vec4));
    gpu::run_once(device(), "depth", [&](gpu::Commands& commands) { gpu::fill(commands, batch.depth, 0); });
    const gpu::Buffer image(device(), "image", 2 * layout.image_bytes(), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT);
    const render::Resolver resolver(device(), render::RaysPerPixel::kWhole, batch, image);
    gpu::run_once(device(), "resolve", [&](gpu::Commands& commands) {
        gpu::fill(commands, image, kUntouched);
        gpu::compute_barrier(commands);
        render::record_resolve(commands, resolver, layout, {});
    });
    std::vector<uint32_t> pixels(2 * size_t{kWidth} * kHeight);
    gpu::download(device(), image, pixels.data(), pixels.size() * 4);
    EXPECT_EQ(pixels[0], 0xffffffffu);
    EXPECT_EQ(std::count(pixels.begin(), pixels.begin() + pixels.size() / 2, 0xff000000u),
              static_cast<ptrdiff_t>(pixels.size() / 2 - 1));
    EXPECT_EQ(std::count(pixels.begin() + pixels.size() / 2, pixels.end(), kUntouched),
              static_cast<ptrdiff_t>(pixels.size() / 2));
}

}  // namespace
}  // namespace neuvv::test
