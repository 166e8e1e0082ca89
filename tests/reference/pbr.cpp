#include "reference/pbr.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/set.h"

namespace neuvv::reference {

namespace {

// GGX: D(h) of microfacets, by the tangent of their slope.
double ggx(double alpha, double nh) {
    const double tan2 = (1 - nh * nh) / (nh * nh);
    return 1 / (std::numbers::pi * alpha * alpha * std::pow(nh, 4) * std::pow(1 + tan2 / (alpha * alpha), 2));
}

// D V: GGX, and Smith's height-correlated masking and shadowing over 4 N·L N·V by way of Λ.
double specular_lobe(double roughness, double nl, double nv, double nh) {
    const double alpha = roughness * roughness;
    const auto lambda = [&](double cosine) {
        return (std::sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine)) - 1) / 2;
    };
    return ggx(alpha, nh) / ((1 + lambda(nl) + lambda(nv)) * 4 * nl * nv);
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
    const glm::dvec3 diffuse = (1 - material.metallic) * material.base_colour / std::numbers::pi;
    return (glm::dvec3(1) - fresnel) * diffuse + fresnel * lobe;
}

glm::dvec3 reflect_ambient(const PbrMaterial& material, glm::dvec3 normal, glm::dvec3 to_eye, glm::dvec3 irradiance,
                           glm::dvec3 mirrored) {
    const double nv = std::clamp(std::abs(glm::dot(normal, to_eye)), 1e-4, 1.0), rough = clamped(material.roughness);
    const double white = 0.96705 - 0.41489 * rough + 0.24268 * nv + 0.80682 * std::pow(rough, 2) -
                         0.38628 * rough * nv - 0.0776 * std::pow(nv, 2) - 0.45898 * std::pow(rough, 3) -
                         1.12013 * std::pow(rough, 2) * nv + 0.85959 * rough * std::pow(nv, 2) -
                         0.14802 * std::pow(nv, 3);
    const double black = std::pow(1 - nv, 2) * (-0.35393 + 2.13922 * rough - 1.93464 * std::pow(rough, 2)) +
                         std::pow(1 - nv, 4) * (1.49411 - 4.7986 * rough + 3.50087 * std::pow(rough, 2)) -
                         0.00487 * std::pow(rough, 2);
    const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), material.base_colour, material.metallic);
    const glm::dvec3 albedo = glm::clamp(f0 * white + (glm::dvec3(1) - f0) * black, glm::dvec3(0), glm::dvec3(1));
    const glm::dvec3 diffuse = (1 - material.metallic) * material.base_colour;
    return (glm::dvec3(1) - albedo) * diffuse * irradiance + albedo * mirrored;
}

glm::dvec2 specular_albedo(double roughness, double nv, int steps) {
    const double alpha = std::pow(clamped(roughness), 2);
    const glm::dvec3 eye(std::sqrt(1 - nv * nv), 0, nv);
    glm::dvec2 sum(0);
    for (int i = 0; i < steps; ++i)
        for (int k = 0; k < steps; ++k) {
            // Half vectors as dense as D N·H; dω_l = 4 V·H dω_h.
            const double u = (i + 0.5) / steps, phi = std::numbers::pi * (k + 0.5) / steps;
            const double nh = std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u)), sine = std::sqrt(1 - nh * nh);
            const glm::dvec3 half(sine * std::cos(phi), sine * std::sin(phi), nh);
            const double vh = glm::dot(eye, half), nl = 2 * vh * nh - nv;
            if (vh <= 0 || nl <= 0) continue;
            const double d = ggx(alpha, nh);
            const double sent = specular_lobe(clamped(roughness), nl, nv, nh) / (d * nh) * 4 * vh * nl / steps / steps;
            sum += sent * glm::dvec2(1 - std::pow(1 - vh, 5), std::pow(1 - vh, 5));
        }
    return sum;
}

}  // namespace neuvv::reference
