// The low-pass of performers' shadow maps against double precision.
#include "render/volume/shadow_blur.h"
#include "gpu/host_copies.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "reference/shadow_blur.h"
#include "shared/lights.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

using ShadowBlurTest = GpuTest;

constexpr uint32_t kMapSide = kPerformerShadowSide, kTexels = kMapSide * kMapSide;

// Alpha in a third of the texels, up to the edges, with metres that are no number where alpha is 0.
std::vector<reference::ShadowTexel> random_texels(uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<float> share(0, 1);
    std::vector<reference::ShadowTexel> texels(kTexels);
    for (reference::ShadowTexel& texel : texels)
        texel = share(random) < 0.3f ? reference::ShadowTexel{share(random), 1 + 4 * share(random)}
                                     : reference::ShadowTexel{0, NAN};
    return texels;
}

// Puts the texels where the rays of a view have them: tile by tile.
void put_view(uint32_t view, const std::vector<reference::ShadowTexel>& texels, std::vector<glm::vec4>& radiance,
              std::vector<float>& depth) {
    for (uint32_t y = 0; y < kMapSide; ++y)
        for (uint32_t x = 0; x < kMapSide; ++x) {
            const uint32_t tile = (y / kTile) * (kMapSide / kTile) + x / kTile;
            const size_t ray = size_t{view} * kTexels + tile * kTilePixels + y % kTile * kTile + x % kTile;
            radiance[ray] = glm::vec4(0.5f, 0.5f, 0.5f, static_cast<float>(texels[y * kMapSide + x].alpha));
            depth[ray] = static_cast<float>(texels[y * kMapSide + x].metres);
        }
}

// Not a number is infinitely far from any.
double difference(double a, double b) {
    return std::isnan(a) ? INFINITY : std::abs(a - b);
}

void expect_reference(std::span<const glm::vec2> drawn, const std::vector<reference::ShadowTexel>& texels) {
    const std::vector<reference::ShadowTexel> truth = reference::blurred_shadow(texels, kMapSide);
    double alpha = 0, metres = 0;
    for (size_t i = 0; i < kTexels; ++i) {
        alpha = std::max(alpha, difference(drawn[i].x, truth[i].alpha));
        metres = std::max(metres, difference(drawn[i].y, truth[i].metres));
    }
    EXPECT_LT(alpha, 1e-6) << "sums of 22 products in single precision";
    EXPECT_LT(metres, 1e-5);
}

TEST_F(ShadowBlurTest, IsTheReferenceAlongBothAxes) {
    const std::vector<uint32_t> map_of_view = {1, 2};
    const render::RayBatch rays(device(), 1, 2 * kTexels / kTilePixels);
    const gpu::Buffer maps(device(), "maps", uint64_t{8} * 3 * kTexels, gpu::MemoryKind::kDevice,
                           VK_FORMAT_R32G32_SFLOAT);
    const render::ShadowBlur blur(device(), rays, maps);
    const std::vector<reference::ShadowTexel> first = random_texels(3), second = random_texels(4);
    std::vector<glm::vec4> radiance(size_t{2} * kTexels);
    std::vector<float> depth(radiance.size());
    put_view(0, first, radiance, depth);
    put_view(1, second, radiance, depth);
    gpu::upload(device(), rays.radiance, radiance.data(), radiance.size() * sizeof(glm::vec4));
    gpu::upload(device(), rays.depth, depth.data(), depth.size() * sizeof(float));
    gpu::run_once(device(), "clear", [&](gpu::Commands& commands) { gpu::fill(commands, maps, 0); });
    gpu::run_once(device(), "shadow blur",
                  [&](gpu::Commands& commands) { record_shadow_blur(commands, blur, map_of_view); });
    std::vector<glm::vec2> drawn(size_t{3} * kTexels);
    gpu::download(device(), maps, drawn.data(), drawn.size() * sizeof(glm::vec2));

    const std::span<const glm::vec2> all(drawn);
    expect_reference(all.subspan(kTexels, kTexels), first);
    expect_reference(all.subspan(2 * kTexels, kTexels), second);
    EXPECT_TRUE(std::all_of(drawn.begin(), drawn.begin() + kTexels, [](glm::vec2 t) { return t == glm::vec2(0); }))
        << "the map of no view";
}

}  // namespace
}  // namespace neuvv::test
