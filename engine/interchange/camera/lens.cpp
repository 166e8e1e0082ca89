#include "interchange/camera/lens.h"

#include <algorithm>
#include <cmath>

namespace neuvv::interchange {

namespace {

constexpr double kSmallest = 1e-9;  // for radii and angles below this, the limit is used in place of 0/0

// The radial factor at the distance from the axis (Brown) or the angle to it (fisheye) whose square is given.
double radial_factor(const Lens& lens, double squared) {
    const auto& k = lens.k;
    const double s = squared;
    if (lens.model == LensModel::kBrown)
        return (1 + s * (k[0] + s * (k[1] + s * k[2]))) / (1 + s * (k[3] + s * (k[4] + s * k[5])));
    return 1 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3])));
}

glm::dvec2 distort(const Lens& lens, glm::dvec2 p) {
    const double squared = glm::dot(p, p), product = 2 * p.x * p.y;
    return radial_factor(lens, squared) * p +
           glm::dvec2(lens.p1 * product + lens.p2 * (squared + 2 * p.x * p.x) + lens.s1 * squared,
                      lens.p2 * product + lens.p1 * (squared + 2 * p.y * p.y) + lens.s2 * squared);
}

// atan(2 r tan(ω/2)) / (ω r)
double fov_factor(double omega, double r) {
    if (std::abs(omega) < kSmallest) return 1;
    const double slope = 2 * std::tan(0.5 * omega);
    return r < kSmallest ? slope / omega : std::atan(slope * r) / (omega * r);
}

// Distances from the axis along a radius of the image, before and after distortion, without tangential terms.
struct Spoke {
    double undistorted, distorted;
};
Spoke spoke_at(const Lens& lens, double r) {
    const double rho = lens.model == LensModel::kFisheye ? std::atan(r) : r;
    switch (lens.model) {
        case LensModel::kPinhole:
            return {rho, rho};
        case LensModel::kFov:
            return {rho, rho * fov_factor(lens.k[0], rho)};
        default:
            return {rho, rho * radial_factor(lens, rho * rho)};
    }
}

glm::dvec2 bend(const Lens& lens, glm::dvec2 xy) {
    const double r = glm::length(xy);
    switch (lens.model) {
        case LensModel::kPinhole:
            return xy;
        case LensModel::kBrown:
            return distort(lens, xy);
        case LensModel::kFisheye:
            return distort(lens, r < kSmallest ? xy : xy * (std::atan(r) / r));
        case LensModel::kFov:
            return xy * fov_factor(lens.k[0], r);
    }
    return xy;
}

}  // namespace

bool Lens::distorts() const {
    if (model == LensModel::kPinhole) return false;
    if (model == LensModel::kFisheye) return true;  // even where all coefficients are 0
    return p1 != 0 || p2 != 0 || s1 != 0 || s2 != 0 || std::any_of(k.begin(), k.end(), [](double c) { return c != 0; });
}

Lens scaled(Lens lens, uint32_t width, uint32_t height) {
    const double across = static_cast<double>(width) / lens.width, down = static_cast<double>(height) / lens.height;
    lens.fx *= across;
    lens.cx *= across;
    lens.fy *= down;
    lens.cy *= down;
    lens.width = width;
    lens.height = height;
    return lens;
}

// The map keeps its orientation while the stretch of its radial part, both along a radius and across it, exceeds what
// the tangential and prism terms can take away: their Jacobian is at most 6 (|p1| + |p2|) ρ + 2 (|s1| + |s2|) ρ.
double fold_radius(const Lens& lens, double limit) {
    constexpr int kSteps = 4096;
    const double tilt = 6 * (std::abs(lens.p1) + std::abs(lens.p2)) + 2 * (std::abs(lens.s1) + std::abs(lens.s2));
    Spoke before = spoke_at(lens, 0);
    for (int i = 1; i <= kSteps; ++i) {
        const Spoke now = spoke_at(lens, limit * i / kSteps);
        const double taken = tilt * now.undistorted;
        const double along = (now.distorted - before.distorted) / (now.undistorted - before.undistorted);
        if (!(along > taken && now.distorted / now.undistorted > taken)) return limit * (i - 1) / kSteps;
        before = now;
    }
    return limit;
}

std::optional<glm::dvec2> direction_at(const Lens& lens, glm::dvec2 pixel) {
    constexpr double kStep = 1e-6, kClose = 1e-6;  // of a direction; pixels
    constexpr double kWidest = 10;                 // 84° from the axis
    constexpr int kMostSteps = 50;
    glm::dvec2 xy = (pixel - glm::dvec2(lens.cx, lens.cy)) / glm::dvec2(lens.fx, lens.fy);
    for (int i = 0; i < kMostSteps; ++i) {  // Newton's method, by differences
        const glm::dvec2 off = pixel - project(lens, xy);
        if (glm::length(off) < kClose)
            return glm::length(xy) <= fold_radius(lens, kWidest) ? std::optional(xy) : std::nullopt;
        const glm::dmat2 slope(
            (project(lens, xy + glm::dvec2(kStep, 0)) - project(lens, xy - glm::dvec2(kStep, 0))) / (2 * kStep),
            (project(lens, xy + glm::dvec2(0, kStep)) - project(lens, xy - glm::dvec2(0, kStep))) / (2 * kStep));
        if (!(std::abs(glm::determinant(slope)) > 1e-9)) return std::nullopt;
        xy += glm::inverse(slope) * off;
    }
    return std::nullopt;
}

glm::dvec2 project(const Lens& lens, glm::dvec2 xy) {
    return glm::dvec2(lens.cx, lens.cy) + glm::dvec2(lens.fx, lens.fy) * bend(lens, xy);
}

}  // namespace neuvv::interchange
