#include "training/capture/dome.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace neuvv::training {

namespace {

constexpr double kStagger = 0.5 * (std::numbers::phi - 1);  // share of a ring's step per ring, so that none line up

// The number of cameras of each ring, by the method of largest remainders; of equal ones, the lower ring's counts
// first.
std::array<uint32_t, kRings> cameras_of_rings(uint32_t count) {
    std::array<double, kRings> share{};
    double sum = 0;
    for (size_t r = 0; r < kRings; ++r) sum += share[r] = std::cos(glm::radians(kRingElevation_deg[r]));
    std::array<uint32_t, kRings> cameras{};
    uint32_t given = 0;
    for (size_t r = 0; r < kRings; ++r) {
        share[r] *= count / sum;
        given += cameras[r] = static_cast<uint32_t>(share[r]);
    }
    for (; given < count; ++given) {
        size_t best = 0;
        for (size_t r = 1; r < kRings; ++r)
            if (share[r] - cameras[r] > share[best] - cameras[best] + 1e-9) best = r;
        ++cameras[best];
    }
    return cameras;
}

}  // namespace

DomeCamera dome_camera(uint32_t ring, double azimuth, double elevation) {
    DomeCamera camera;
    camera.ring = ring;
    camera.outward = {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                      std::cos(elevation) * std::cos(azimuth)};
    const glm::dvec3 right(std::cos(azimuth), 0, -std::sin(azimuth));
    camera.world_from_camera = {right, glm::cross(camera.outward, right), camera.outward};
    return camera;
}

std::vector<DomeCamera> dome_cameras(uint32_t count) {
    std::vector<DomeCamera> dome;
    const std::array<uint32_t, kRings> cameras = cameras_of_rings(count);
    for (uint32_t ring = 0; ring < kRings; ++ring) {
        const double elevation = glm::radians(kRingElevation_deg[ring]);
        for (uint32_t i = 0; i < cameras[ring]; ++i) {
            const double azimuth = 2 * std::numbers::pi * (i + kStagger * ring) / cameras[ring];
            dome.push_back(dome_camera(ring, azimuth, elevation));
        }
    }
    return dome;
}

std::vector<bool> held_out(uint32_t count, double share) {
    std::vector<bool> is_test(count, false);
    if (share <= 0) return is_test;
    assert(count >= 2 && "one camera cannot be shared between training and test");
    const auto rounded = static_cast<uint32_t>(std::lround(share * count));
    const uint32_t test_count = std::clamp(rounded, 1u, count - 1);
    // The dome's cameras, in order, are divided into `test_count` equal stretches. Of each stretch, the camera that is
    // farthest from those selected before is selected.
    const std::vector<DomeCamera> dome = dome_cameras(count);
    std::vector<size_t> selected{count / test_count / 2};
    for (uint32_t k = 1; k < test_count; ++k) {
        size_t best = 0;
        double best_distance = -1;
        for (size_t i = size_t{k} * count / test_count; i < size_t{k + 1} * count / test_count; ++i) {
            double nearest = 2;
            for (const size_t c : selected) nearest = std::min(nearest, glm::length(dome[i].outward - dome[c].outward));
            if (nearest > best_distance) best = i;
            best_distance = std::max(best_distance, nearest);
        }
        selected.push_back(best);
    }
    for (const size_t c : selected) is_test[c] = true;
    return is_test;
}

DomeFit dome_fit(const glm::dvec3& centre, uint32_t width, uint32_t height) {
    constexpr double kViewAngle_deg = 30, kMargin = 0.04;
    DomeFit fit;
    fit.centre = centre;
    const double focal = 1 / std::tan(glm::radians(0.5 * kViewAngle_deg)), shorter = std::min(width, height);
    fit.focal = {focal * shorter / width, focal * shorter / height};
    fit.margin = kMargin;
    return fit;
}

void include_points(DomeFit& fit, const std::vector<DomeCamera>& dome, const std::vector<glm::vec3>& points) {
    const glm::dvec2 slope = fit.focal / (1 - fit.margin);
    for (const DomeCamera& camera : dome) {
        // A point p lies at the depth radius − p·outward. It is inside the image if |p·right| · focal ≤ depth · (1 −
        // margin), and the same for up.
        const glm::vec3 right = camera.world_from_camera[0] * slope.x, up = camera.world_from_camera[1] * slope.y;
        const glm::vec3 outward = camera.outward, centre = fit.centre;
        float farthest = 0;
        for (const glm::vec3& point : points) {
            const glm::vec3 p = point - centre;
            const float aside = std::max(std::abs(glm::dot(p, right)), std::abs(glm::dot(p, up)));
            farthest = std::max(farthest, glm::dot(p, outward) + aside);
        }
        fit.radius = std::max(fit.radius, static_cast<double>(farthest));
    }
}

stage::Camera make_camera(const DomeCamera& from, const DomeFit& fit, uint32_t width, uint32_t height) {
    stage::Camera camera;
    camera.world_from_camera = glm::dmat4(from.world_from_camera);
    camera.world_from_camera[3] = glm::dvec4(fit.centre + fit.radius * from.outward, 1);
    camera.width = width;
    camera.height = height;
    camera.fx = 0.5 * width * fit.focal.x;
    camera.fy = 0.5 * height * fit.focal.y;
    camera.cx = 0.5 * width;
    camera.cy = 0.5 * height;
    return camera;
}

}  // namespace neuvv::training
