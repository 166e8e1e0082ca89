// Lenses as calibration programs describe them: they take a direction to a pixel, distortion included.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

namespace neuvv::interchange {

// Camera coordinates X, Y, Z have OpenCV axes (x right, y down, z forward); x = X/Z, y = Y/Z, r² = x² + y², θ = atan r.
enum class LensModel : uint8_t {
    kPinhole,
    kBrown,  // OpenCV: radial (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶), tangential p1, p2
    kFisheye,  // OpenCV's fisheye: θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸). Followed by tangential p1, p2 and thin prism
               // s1, s2 it is COLMAP's THIN_PRISM_FISHEYE
    kFov,  // COLMAP's FOV: r_d = atan(2 r tan(ω/2)) / ω, k[0] = ω
};

struct Lens {
    LensModel model = LensModel::kPinhole;
    double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels; pixel centres are at +½
    std::array<double, 6> k{};              // k1 … k6; terms that a model does not have are 0
    double p1 = 0, p2 = 0, s1 = 0, s2 = 0;
    uint32_t width = 0, height = 0;  // of the images that fx, fy, cx, cy are for; 0: the images' own size

    bool distorts() const;  // false: straight lines look straight
};

// The same lens for images scaled to this size. The lens must know its own size.
Lens scaled(Lens lens, uint32_t width, uint32_t height);

// The pixel position at which the lens shows the direction (x, y, 1).
glm::dvec2 project(const Lens& lens, glm::dvec2 xy);

// The direction (x, y, 1) that the lens shows at the pixel position; nothing where there is none, as in the corners of
// a lens that folds over.
std::optional<glm::dvec2> direction_at(const Lens& lens, glm::dvec2 pixel);

// The smallest distance √(x² + y²) from the axis, up to `limit`, at which the lens folds over: directions (x, y, 1)
// further out come back towards the centre of the image. Returns `limit` where the lens does not fold.
double fold_radius(const Lens& lens, double limit);

}  // namespace neuvv::interchange
