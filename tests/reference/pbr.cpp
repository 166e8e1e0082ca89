#include "reference/pbr.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/set.h"

namespace neuvv::reference {

namespace {

constexpr double kPi = std::numbers::pi;

// D V: GGX, and Smith's height-correlated masking and shadowing over 4 N·L N·V by way of Λ.
double specular_lobe(double roughness, double nl, double nv, double nh) {
    const double alpha = roughness * roughness;
    const double tan2 = (1 - nh * nh) / (nh * nh);
    const double d = 1 / (kPi * alpha * alpha * std::pow(nh, 4) * std::pow(1 + tan2 / (alpha * alpha), 2));
    const auto lambda = [&](double cosine) {
        return (std::sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine)) - 1) / 2;
    };
    return d / ((1 + lambda(nl) + lambda(nv)) * 4 * nl * nv);
}

double clamped(double roughness) {
    return std::max(roughness, static_cast<double>(kMinRoughness));
}

}  // namespace

glm::dvec3 brdf(const PbrMaterial& material, glm::dvec3 normal, glm::dvec3 to_eye, glm::dvec3 to_light) {
    const glm::dvec3 half = glm::normalize(to_eye + to_light);
    const double nl = glm::dot(normal, to_light), nv = std::max(std::abs(glm::dot(normal, to_eye)), 1e-4);
    if (nl <= 0) return glm::dvec3(0);
    const double grazing = std::pow(1 - glm::dot(to_eye, half), 5);
    const double lobe = specular_lobe(clamped(material.roughness), nl, nv, glm::dot(normal, half));
    // fresnel_mix of a dielectric, and conductor_fresnel, mixed by metallic: with both in F it is one expression.
    const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), material.base_colour, material.metallic);
    const glm::dvec3 fresnel = f0 + (glm::dvec3(1) - f0) * grazing;
    const glm::dvec3 diffuse = (1 - material.metallic) * material.base_colour / kPi;
    return (glm::dvec3(1) - fresnel) * diffuse + fresnel * lobe;
}

glm::dvec3 reflect_ambient(const PbrMaterial& material, glm::dvec3 normal, glm::dvec3 to_eye, glm::dvec3 irradiance,
                           glm::dvec3 mirrored) {
    const double nv = std::clamp(std::abs(glm::dot(normal, to_eye)), 1e-4, 1.0), rough = clamped(material.roughness);
    const glm::dvec4 c0(-1, -0.0275, -0.572, 0.022), c1(1, 0.0425, 1.04, -0.04), r = rough * c0 + c1;
    const double a = std::min(r.x * r.x, std::exp2(-9.28 * nv)) * r.x + r.y;
    const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), material.base_colour, material.metallic);
    const glm::dvec3 albedo =
        glm::clamp(f0 * (-1.04 * a + r.z) + glm::dvec3(1.04 * a + r.w), glm::dvec3(0), glm::dvec3(1));
    const glm::dvec3 diffuse = (1 - material.metallic) * material.base_colour;
    return (glm::dvec3(1) - albedo) * diffuse * irradiance + albedo * mirrored;
}

glm::dvec2 specular_albedo(double roughness, double nv, int steps) {
    const glm::dvec3 eye(std::sqrt(1 - nv * nv), 0, nv);
    glm::dvec2 sum(0);
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < 2 * steps; k++) {
            const double cosine = (i + 0.5) / steps, sine = std::sqrt(1 - cosine * cosine);
            const double phi = kPi * (k + 0.5) / steps, solid_angle = kPi / steps / steps;
            const glm::dvec3 light(sine * std::cos(phi), sine * std::sin(phi), cosine);
            const glm::dvec3 half = glm::normalize(eye + light);
            const double grazing = std::pow(1 - glm::dot(eye, half), 5);
            const double sent = specular_lobe(clamped(roughness), cosine, nv, half.z) * cosine * solid_angle;
            sum += sent * glm::dvec2(1 - grazing, grazing);
        }
    return sum;
}

}  // namespace neuvv::reference
