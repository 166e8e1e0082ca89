// Lenses as calibration programs describe them: from a direction to a pixel, distortion included.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace neuvv::training {

// In camera coordinates of OpenCV axes (x right, y down, z forward); x = X/Z, y = Y/Z, r² = x² + y², θ = atan r.
enum class LensModel : uint8_t {
    kPinhole,
    kBrown,  // OpenCV: radial (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶), tangential p1, p2
    kFisheye,  // OpenCV's fisheye: θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸); with tangential p1, p2 and thin prism
               // s1, s2 after it COLMAP's THIN_PRISM_FISHEYE
    kFov,  // COLMAP's FOV: r_d = atan(2 r tan(ω/2)) / ω, k[0] = ω
};

struct Lens {
    LensModel model = LensModel::kPinhole;
    double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels; pixel centres are at +½
    std::array<double, 6> k{};              // k1 … k6; those that a model lacks are 0
    double p1 = 0, p2 = 0, s1 = 0, s2 = 0;
    uint32_t width = 0, height = 0;  // of the images that fx, fy, cx, cy are for; 0: that of the images

    bool distorts() const;  // false: straight lines stay straight
};

// The same lens for images scaled to this size.
Lens scaled(Lens lens, uint32_t width, uint32_t height);

// Where the lens puts the direction (x, y, 1), in pixels.
glm::dvec2 project(const Lens& lens, glm::dvec2 xy);

// Smallest distance from the axis (of the direction (x, y, 1)), up to `limit`, at which the lens folds over: directions
// further out come back towards the middle of the image. `limit` where there is none.
double fold_radius(const Lens& lens, double limit);

}  // namespace neuvv::training
