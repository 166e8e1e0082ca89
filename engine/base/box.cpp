#include "base/box.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace neuvv {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The volume spanned by the normalised axes of a matrix below which the matrix counts as singular.
constexpr double kMinVolume = 1e-12;

bool is_finite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The inverse of a linear map in two factors: `turn` inverts the normalised axes, then `lengths` divides. So a box of a
// millimetre is no nearer to being singular than one of a metre.
struct Inverse {
    glm::dmat3 turn{1};
    glm::dvec3 lengths{1};
    glm::dvec3 operator()(glm::dvec3 v) const { return turn * v / lengths; }
};
std::optional<Inverse> inverse_of(const glm::dmat3& linear) {
    Inverse inverse;
    glm::dmat3 axes = linear;
    for (int i = 0; i < 3; ++i) {
        inverse.lengths[i] = glm::length(linear[i]);
        axes[i] /= inverse.lengths[i];
    }
    const double volume = std::abs(glm::determinant(axes));
    if (!is_finite(inverse.lengths) || !(volume >= kMinVolume)) return {};  // NaN where a length is 0
    inverse.turn = glm::inverse(axes);
    return inverse;
}

double lowest_of(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high) {
    double lowest = world_from_node[3].y;
    for (int i = 0; i < 3; ++i) {
        const double a = world_from_node[i].y * low[i], b = world_from_node[i].y * high[i];
        lowest += a < b ? a : b;
    }
    return lowest;
}

}  // namespace

std::optional<glm::dvec3> unit_direction(const Ray& ray) {
    const double length = glm::length(ray.direction);
    if (!is_finite(ray.origin) || !std::isfinite(length) || length == 0) return {};
    return ray.direction / length;
}

std::optional<double> box_hit(const Ray& ray, const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high) {
    const std::optional<glm::dvec3> along = unit_direction(ray);
    const std::optional<Inverse> box_from_world = inverse_of(glm::dmat3(world_from_box));
    if (!along || !box_from_world) return {};
    // The direction is not normalised in the space of the box, so parameters along the ray remain metres of the world.
    const glm::dvec3 origin = (*box_from_world)(ray.origin - glm::dvec3(world_from_box[3])),
                     direction = (*box_from_world)(*along);
    if (!is_finite(origin) || !is_finite(direction)) return {};
    double enter = 0, leave = kInfinity;
    for (int i = 0; i < 3; ++i) {
        if (!(low[i] <= high[i])) return {};
        if (direction[i] == 0) {
            if (origin[i] < low[i] || origin[i] > high[i]) return {};
            continue;
        }
        const double a = (low[i] - origin[i]) / direction[i], b = (high[i] - origin[i]) / direction[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (enter > leave || !std::isfinite(enter)) return {};
    return enter;
}

double above_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y) {
    return lowest_of(world_from_node, low, high) - floor_y;
}

glm::dmat4 on_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y) {
    glm::dmat4 standing = world_from_node;
    const double above = above_floor(world_from_node, low, high, floor_y);
    if (std::isfinite(above)) standing[3].y -= above;
    return standing;
}

}  // namespace neuvv
