// hh.glsl and sh.glsl against the reference.
#include "reference/hh.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "reference_test/numeric.h"
#include "render/hh_probe.h"
#include "spirv/hh_probe.comp.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

std::vector<glm::vec4> probe_points() {
    Random random(5);
    const double pi = std::numbers::pi;
    std::vector<double> gammas = {0, 1e-6, 1e-3, pi / 2, pi - 1e-3, pi - 1e-6, pi};
    for (int i = 0; i < 200; ++i) gammas.push_back(random.uniform(0, pi));
    std::vector<glm::vec4> points;
    for (const double gamma : gammas)
        points.emplace_back(glm::vec3(reference::test::random_direction(random)), static_cast<float>(gamma));
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec4 point(0, 0, 0, 1);
            point[axis] = sign;
            points.push_back(point);
        }
    return points;
}

std::vector<HhProbe> probe(const gpu::Device& device, const std::vector<glm::vec4>& points, uint32_t degree) {
    const gpu::Buffer in(device, "points", points.size() * sizeof(glm::vec4), gpu::MemoryKind::kDevice);
    const gpu::Buffer out(device, "probes", points.size() * sizeof(HhProbe), gpu::MemoryKind::kDevice);
    gpu::upload(device, in, points.data(), points.size() * sizeof(glm::vec4));
    const gpu::ComputePass pass(device, "HH probe", hh_probe_comp, {degree});
    const gpu::BindingSet set(pass, {{kHhProbePoints, &in}, {kHhProbeOut, &out}});
    const auto count = static_cast<uint32_t>(points.size());
    gpu::run_once(device, "HH probe", [&](gpu::Commands& commands) {
        gpu::dispatch(commands, pass, set, count, count);
        gpu::compute_barrier(commands);
    });
    std::vector<HhProbe> probes(points.size());
    gpu::download(device, out, probes.data(), probes.size() * sizeof(HhProbe));
    return probes;
}

// The tolerance of single precision with a GPU's sines and cosines, whose error is absolute, not relative.
constexpr double kTolerance = 1e-5;

void expect_close(double value, double truth, const char* what, int n, int l, double at) {
    EXPECT_LE(std::abs(value - truth), kTolerance * std::max(1.0, std::abs(truth)))
        << what << ' ' << n << ' ' << l << " at " << at << ": " << value << ", reference " << truth;
}

using HhTest = GpuTest;

TEST_F(HhTest, RadialFactorsAndTheirSlopesMatchTheReference) {
    const std::vector<glm::vec4> points = probe_points();
    const std::vector<HhProbe> probes = probe(device(), points, kMaxHhDegree);
    for (size_t i = 0; i < points.size(); ++i)
        for (int l = 0; l < 4; ++l)
            for (int n = 0; n < 4; ++n) {
                const double gamma = points[i].w;
                expect_close(probes[i].radial[l][n], n < l ? 0 : reference::radial(n, l, gamma), "R", n, l, gamma);
                expect_close(probes[i].slope[l][n], n < l ? 0 : reference::radial_slope(n, l, gamma), "dR", n, l,
                             gamma);
            }
}

TEST_F(HhTest, SphericalHarmonicsMatchTheReferenceAndEndAtTheDegree) {
    const std::vector<glm::vec4> points = probe_points();
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const std::vector<HhProbe> probes = probe(device(), points, degree);
        for (size_t i = 0; i < points.size(); ++i) {
            std::vector<double> truth = reference::sh_basis(degree, glm::dvec3(points[i]));
            truth.resize(kMaxShCount, 0.0);
            for (int j = 0; j < static_cast<int>(kMaxShCount); ++j)
                expect_close(probes[i].sh[j / 4][j % 4], truth[static_cast<size_t>(j)], "Y", static_cast<int>(degree),
                             j, points[i].x);
        }
    }
}

// The comparison above must notice a constant that is wrong in the fifth digit.
TEST(HhComparison, NoticesASmallError) {
    EXPECT_NONFATAL_FAILURE(
        expect_close(reference::radial(3, 2, 1.0) + 2e-5, reference::radial(3, 2, 1.0), "R", 3, 2, 1), "reference");
}

}  // namespace
}  // namespace neuvv::test
