// trace_adjoint.comp alone, with both kinds of atomic addition, against the reference.
#include "training/step/trace_adjoint.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <bit>

#include "gradient/agreement.h"
#include "gradient/scene.h"
#include "reference/camera.h"
#include "reference/trace.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

struct SlotSums {
    std::vector<glm::uvec2> head;      // per leaf (σ bits, slot)
    std::vector<float> gradients;      // per slot
    std::vector<uint32_t> max_weight;  // per slot
};

SlotSums scatter_on(const gpu::Device& device, const Scene& scene, const std::vector<glm::vec4>& d_rays,
                    training::AtomicAdd atomics) {
    const render::Field field = render::upload_field(device, scene.tree, render::WeightPrecision::kFloat);
    const render::Slice slice(device, field, field.leaf_count);
    const auto tiles = static_cast<uint32_t>(scene.tiles.size());
    const render::RayBatch rays(device, 2, tiles);
    const training::LossBatch batch(device, tiles);
    const training::SliceGradients gradients(device, field, slice);
    const render::Slicer slicer(device, field, slice);
    const render::Tracer tracer(device, field, slice, rays);
    const training::TraceAdjoint adjoint(device, field, slice, rays, batch, gradients, atomics);
    for (size_t i = 0; i < 2; ++i) rays.cameras.as<ShaderCamera>()[i] = render::shader_camera(scene.cameras[i]);
    std::copy(scene.tiles.begin(), scene.tiles.end(), rays.tiles.as<Tile>());
    gpu::upload(device, batch.target, scene.target.data(), scene.target.size() * sizeof(glm::vec4));
    gpu::upload(device, batch.adjoint, d_rays.data(), d_rays.size() * sizeof(glm::vec4));
    gpu::run_once(device, "trace adjoint", [&](gpu::Commands& commands) {
        render::record_slice(commands, slicer, scene.frame);
        render::record_trace(commands, tracer, tiles, scene.stop);
        training::record_trace_adjoint(commands, adjoint, tiles, scene.stop, LossWeights{}, 1);
    });
    SlotSums sums;
    sums.head.resize(field.leaf_count);
    sums.gradients.resize(size_t{gradient_stride(field.hh_degree)} * slice.capacity);
    sums.max_weight.resize(slice.capacity);
    gpu::download(device, slice.head, sums.head.data(), sums.head.size() * sizeof(glm::uvec2));
    gpu::download(device, gradients.gradients, sums.gradients.data(), sums.gradients.size() * sizeof(float));
    gpu::download(device, gradients.max_weight, sums.max_weight.data(), sums.max_weight.size() * sizeof(uint32_t));
    return sums;
}

// Per leaf: ∂L/∂σ, the opacity sensitivity and ∂L/∂k, and the largest blending weight of a ray that has a derivative.
struct LeafSums {
    std::vector<std::vector<double>> gradients;
    std::vector<double> max_weight;
};

void add_ray(const Scene& scene, const std::vector<reference::LeafSlice>& slices, const reference::Ray& ray,
             glm::dvec4 d_ray, LeafSums& sums) {
    const auto stop = static_cast<double>(scene.stop);
    const std::vector<reference::LeafInterval> intervals = reference::intersect(scene.tree, ray);
    const std::vector<reference::LeafSliceGradient> parts =
        reference::trace_adjoint(scene.tree, slices, ray, glm::dvec3(d_ray), d_ray.a, stop);
    for (size_t i = 0; i < parts.size(); ++i) {
        const reference::LeafSliceGradient& part = parts[i];
        std::vector<double>& leaf = sums.gradients[part.leaf];
        leaf[0] += part.sigma;
        // |α ∂L/∂α| by the chain rule: ∂α/∂σ = δ (1 − α), where 1 − α is at least e⁻⁸, as in the shader
        const double delta = intervals[i].t_exit - intervals[i].t_enter;
        const double clear = std::exp(-std::min(slices[part.leaf].sigma * delta, 8.0));
        leaf[1] += std::abs(part.sigma) * (1 - clear) / (delta * clear);
        for (uint32_t j = 0; j < sh_count(scene.tree.hh_degree); ++j)
            for (uint32_t c = 0; c < 3; ++c) leaf[2 + 3 * j + c] += part.k[c][j];
    }
    double transmittance = 1;
    for (const reference::LeafInterval& interval : intervals) {
        if (transmittance < stop) break;
        const double behind =
            transmittance * std::exp(-slices[interval.leaf].sigma * (interval.t_exit - interval.t_enter));
        sums.max_weight[interval.leaf] = std::max(sums.max_weight[interval.leaf], transmittance - behind);
        transmittance = behind;
    }
}

LeafSums scatter_by_reference(const Scene& scene, const std::vector<glm::vec4>& d_rays) {
    const std::vector<reference::LeafSlice> slices =
        reference::slice_tree(scene.tree, static_cast<double>(scene.frame));
    LeafSums sums{std::vector(scene.tree.leaf_count, std::vector<double>(gradient_stride(scene.tree.hh_degree))),
                  std::vector<double>(scene.tree.leaf_count)};
    for (size_t i = 0; i < d_rays.size(); ++i) {
        const Tile& tile = scene.tiles[i / kTilePixels];
        const size_t x = tile.x + i % kTile, y = tile.y + i % kTilePixels / kTile;
        const stage::Camera& camera = scene.cameras[tile.camera];
        if (x >= camera.width || y >= camera.height || d_rays[i] == glm::vec4(0)) continue;
        add_ray(scene, slices, ray_of(scene, tile, i % kTilePixels), glm::dvec4(d_rays[i]), sums);
    }
    return sums;
}

void expect_scatter(const Scene& scene, const SlotSums& found, const LeafSums& truth) {
    const uint32_t stride = gradient_stride(scene.tree.hh_degree);
    std::vector<GradientPair> sigmas, sensitivities, coefficients, max_weights;
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf) {
        const auto [sigma_bits, slot] = std::pair(found.head[leaf].x, found.head[leaf].y);
        if (std::bit_cast<float>(sigma_bits) == 0 || truth.max_weight[leaf] == 0) continue;
        sigmas.push_back({found.gradients[size_t{slot} * stride], truth.gradients[leaf][0]});
        sensitivities.push_back({found.gradients[size_t{slot} * stride + 1], truth.gradients[leaf][1]});
        for (uint32_t i = 2; i < stride; ++i)
            coefficients.push_back({found.gradients[size_t{slot} * stride + i], truth.gradients[leaf][i]});
        max_weights.push_back({std::bit_cast<float>(found.max_weight[slot]), truth.max_weight[leaf]});
    }
    EXPECT_GT(sigmas.size(), 30u);
    expect_gradients("sigma", sigmas);
    expect_gradients("opacity sensitivity", sensitivities);
    expect_gradients("SH coefficients", coefficients);
    expect_gradients("max weight", max_weights);
}

class TraceAdjointTest : public GpuTest, public ::testing::WithParamInterface<training::AtomicAdd> {};

TEST_P(TraceAdjointTest, ScattersWhatTheReferenceScatters) {
    if (GetParam() == training::AtomicAdd::kNative && !device().float_atomics())
        GTEST_SKIP() << "this device has no atomic addition of floats";
    for (const float stop : {0.0f, 1.0f / 256}) {
        SCOPED_TRACE(stop);
        const Scene scene = random_scene({.tree = {.seed = 3, .leaves = 300, .bases = 5, .hh_degree = 2},
                                          .density = stop > 0 ? 12.0f : 1.0f,
                                          .stop = stop});
        Random random(9);
        std::vector<glm::vec4> d_rays(scene.target.size(), glm::vec4(0));
        for (glm::vec4& d : d_rays)
            for (int c = 0; random.below(8) > 0 && c < 4; ++c) d[c] = static_cast<float>(random.bell());
        expect_scatter(scene, scatter_on(device(), scene, d_rays, GetParam()), scatter_by_reference(scene, d_rays));
    }
}

INSTANTIATE_TEST_SUITE_P(Atomics, TraceAdjointTest,
                         ::testing::Values(training::AtomicAdd::kNative, training::AtomicAdd::kCompareAndSwap),
                         [](const auto& test) {
                             return test.param == training::AtomicAdd::kNative ? "Native" : "CompareAndSwap";
                         });

}  // namespace
}  // namespace neuvv::test
