// glTF 2.0's metallic-roughness material in double precision (specification, appendix B).
#pragma once

#include <glm/glm.hpp>

namespace neuvv::reference {

struct PbrMaterial {
    glm::dvec3 base_colour{1};
    double metallic = 0;
    double roughness = 1;  // perceptual
};

// The bidirectional reflectance; all directions unit, from the surface outwards.
glm::dvec3 brdf(const PbrMaterial& material, glm::dvec3 normal, glm::dvec3 to_eye, glm::dvec3 to_light);

// The ambient light reflected to the eye. `irradiance` is what a white diffuse surface would reflect, `mirrored` the
// light from the mirrored direction. The specular part uses the shader's fit of the split sum.
glm::dvec3 reflect_ambient(const PbrMaterial& material, glm::dvec3 normal, glm::dvec3 to_eye, glm::dvec3 irradiance,
                           glm::dvec3 mirrored);

// The split sum's second factor, which the fit approximates: (A, B) of A f0 + B, by quadrature over steps² half
// vectors.
glm::dvec2 specular_albedo(double roughness, double nv, int steps);

}  // namespace neuvv::reference
