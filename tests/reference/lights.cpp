#include "reference/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::reference {

glm::dvec3 light_at(const render::SetLight& light, glm::dvec3 world, glm::dvec3& to_light) {
    if (light.kind == render::SetLightKind::kDirectional) {
        to_light = -light.direction;
        return light.colour;
    }
    const double distance = std::max(glm::distance(light.position, world), static_cast<double>(kNearestLight));
    to_light = (light.position - world) / distance;
    double attenuation = 1 / (distance * distance);
    if (light.range_m > 0) attenuation *= std::max(std::min(1 - std::pow(distance / light.range_m, 4), 1.0), 0.0);
    if (light.kind == render::SetLightKind::kSpot) {
        const double scale = 1 / std::max(0.001, light.inner_cos - light.outer_cos);
        const double cone = std::clamp((glm::dot(light.direction, -to_light) - light.outer_cos) * scale, 0.0, 1.0);
        attenuation *= cone * cone;
    }
    return attenuation * light.colour;
}

glm::dvec3 irradiance(const std::function<glm::dvec3(glm::dvec3)>& light_from, glm::dvec3 normal, int rows) {
    constexpr double kPi = std::numbers::pi;
    glm::dvec3 sum(0);
    for (int row = 0; row < rows; ++row) {
        const double theta = kPi * (row + 0.5) / rows;
        const double solid_angle = (std::cos(kPi * row / rows) - std::cos(kPi * (row + 1) / rows)) * kPi / rows;
        for (int column = 0; column < 2 * rows; ++column) {
            const double phi = kPi * (column + 0.5) / rows;
            const glm::dvec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            sum += solid_angle * std::max(glm::dot(normal, d), 0.0) * light_from(d);
        }
    }
    return sum / kPi;
}

}  // namespace neuvv::reference
