#include "training/capture/dome.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv {
namespace {

std::array<uint32_t, training::kRings> count_rings(const std::vector<training::DomeCamera>& dome,
                                                   const std::vector<bool>* only = nullptr) {
    std::array<uint32_t, training::kRings> counts{};
    for (size_t i = 0; i < dome.size(); ++i) counts[dome[i].ring] += !only || (*only)[i] ? 1 : 0;
    return counts;
}

TEST(Dome, FourRingsInProportionToTheirCircumference) {
    EXPECT_EQ(count_rings(training::dome_cameras(66)), (std::array<uint32_t, training::kRings>{21, 20, 16, 9}));
    for (uint32_t count = 1; count < 200; ++count) ASSERT_EQ(training::dome_cameras(count).size(), count);
    for (const training::DomeCamera& camera : training::dome_cameras(66))
        EXPECT_NEAR(std::asin(camera.outward.y), glm::radians(training::kRingElevation_deg[camera.ring]), 1e-12);
}

TEST(Dome, CamerasLookAtTheCentreWithTheSkyUp) {
    training::DomeFit fit;
    fit.centre = {1, 2, 3};
    fit.radius = 4;
    for (const training::DomeCamera& from : training::dome_cameras(66)) {
        const stage::Camera camera = training::make_camera(from, fit, 100, 100);
        const glm::dmat3 axes(camera.world_from_camera);
        EXPECT_NEAR(glm::determinant(axes), 1, 1e-12);
        EXPECT_LT(glm::length(axes[2] * 4.0 - (glm::dvec3(camera.world_from_camera[3]) - fit.centre)), 1e-12);
        EXPECT_NEAR(axes[0].y, 0, 1e-12) << "level horizon";
        EXPECT_GT(axes[1].y, 0.3) << "not upside down";
    }
}

TEST(Dome, NoTwoCamerasAreClose) {
    const auto dome = training::dome_cameras(66);
    double closest = 2;
    for (size_t i = 0; i < dome.size(); ++i)
        for (size_t k = 0; k < i; ++k) closest = std::min(closest, glm::length(dome[i].outward - dome[k].outward));
    EXPECT_GT(closest, 0.25);
}

TEST(Dome, HoldoutIsSpreadOverRingsAndAround) {
    const auto dome = training::dome_cameras(66);
    const std::vector<bool> is_test = training::held_out(66, 0.1);
    EXPECT_EQ(std::count(is_test.begin(), is_test.end(), true), 7);
    for (const uint32_t in_ring : count_rings(dome, &is_test)) {
        EXPECT_GE(in_ring, 1u);
        EXPECT_LE(in_ring, 3u);
    }
    for (size_t i = 0; i < dome.size(); ++i)
        for (size_t k = 0; k < i; ++k)
            if (is_test[i] && is_test[k]) {
                EXPECT_GT(glm::length(dome[i].outward - dome[k].outward), 0.5) << i << " " << k;
            }
}

TEST(Dome, HoldoutLeavesOneOfEachKind) {
    const auto count = [](uint32_t cameras, double share) {
        const std::vector<bool> is_test = training::held_out(cameras, share);
        return std::count(is_test.begin(), is_test.end(), true);
    };
    EXPECT_EQ(count(66, 0), 0);
    EXPECT_EQ(count(4, 0.01), 1);
    EXPECT_EQ(count(4, 0.99), 3);
    EXPECT_EQ(count(2, 0.5), 1);
    EXPECT_EQ(count(10, 0.3), 3);
    for (uint32_t cameras = 2; cameras < 100; ++cameras)
        EXPECT_EQ(count(cameras, 0.25), std::clamp<long>(std::lround(0.25 * cameras), 1, cameras - 1));
}

TEST(Dome, TheSmallestRadiusThatHoldsEveryPoint) {
    const auto dome = training::dome_cameras(20);
    training::DomeFit fit;
    fit.centre = {0.5, 1, 0};
    fit.focal = {3, 2};
    fit.margin = 0.1;
    const std::vector<glm::vec3> points = {{1.4f, 1, 0}, {0, 0, 0.3f}, {0.5f, 2.1f, -0.5f}};
    training::include_points(fit, dome, points);
    double largest = 0;
    for (const training::DomeCamera& from : dome) {
        const stage::Camera camera = training::make_camera(from, fit, 200, 300);
        for (const glm::vec3& point : points) {
            const glm::dvec3 p(glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1));
            ASSERT_LT(p.z, 0);
            largest = std::max({largest, std::abs(camera.fx * p.x / p.z) / 100, std::abs(camera.fy * p.y / p.z) / 150});
        }
    }
    EXPECT_NEAR(largest, 0.9, 1e-5);
}

}  // namespace
}  // namespace neuvv
