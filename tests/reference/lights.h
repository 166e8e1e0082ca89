// The lights of a stage in double precision: KHR_lights_punctual, and ambient light.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "render/set/set_lights.h"

namespace neuvv::reference {

// The light on a surface that faces the light, without shadows, in lux; `to_light` is unit.
glm::dvec3 light_at(const render::SetLight& light, glm::dvec3 world, glm::dvec3& to_light);

// The ambient light that a white diffuse surface reflects: ∫ L(d) max(n·d, 0) dω / π, by quadrature over `rows` bands.
glm::dvec3 irradiance(const std::function<glm::dvec3(glm::dvec3)>& light_from, glm::dvec3 normal, int rows);

}  // namespace neuvv::reference
