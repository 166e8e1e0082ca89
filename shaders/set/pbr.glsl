// glTF 2.0's metallic-roughness material (specification, appendix B): how much a surface reflects to the eye of light
// from one direction, and of ambient light.
#ifndef NEUVV_PBR_GLSL
#define NEUVV_PBR_GLSL
#include "shared/set.h"

const float kPi = 3.14159265358979;

struct Surface {
    vec3 diffuse;     // reflectance
    vec3 f0;          // specular reflectance along the normal
    float roughness;  // perceptual: α is its square
    vec3 normal;      // world, unit, towards the eye
};

Surface surface_of(vec3 base_colour, float metallic, float roughness, vec3 normal) {
    return Surface(base_colour * (1.0 - metallic), mix(vec3(0.04), base_colour, metallic),
                   max(roughness, kMinRoughness), normal);
}

// Light reflected to the eye for each unit of light that falls on a surface facing `to_light`:
//   ((1 − F) c_diff / π + F D V) · N·L,   F = f0 + (1 − f0)(1 − V·H)⁵
//   D = α² / (π ((N·H)²(α² − 1) + 1)²)                                                        GGX
//   V = 1 / (2 (N·L √((N·V)²(1 − α²) + α²) + N·V √((N·L)²(1 − α²) + α²)))                     Smith, height-correlated
vec3 reflect_light(Surface s, vec3 to_eye, vec3 to_light) {
    const float nl = dot(s.normal, to_light);
    if (nl <= 0.0) return vec3(0.0);
    const float nv = max(abs(dot(s.normal, to_eye)), 1e-4);
    const vec3 centre = normalize(to_eye + to_light + 1e-7 * s.normal);
    const float nh = clamp(dot(s.normal, centre), 0.0, 1.0), vh = clamp(dot(to_eye, centre), 0.0, 1.0);
    const float alpha2 = s.roughness * s.roughness * s.roughness * s.roughness;
    const float lobe = nh * nh * (alpha2 - 1.0) + 1.0;
    const float d = alpha2 / (kPi * lobe * lobe);
    const float v = 0.5 / (nl * sqrt(nv * nv * (1.0 - alpha2) + alpha2) + nv * sqrt(nl * nl * (1.0 - alpha2) + alpha2));
    const float grazing = pow(1.0 - vh, 5.0);
    const vec3 f = s.f0 + (1.0 - s.f0) * grazing;
    return ((1.0 - f) * s.diffuse / kPi + f * (d * v)) * nl;
}

// How much of a uniform light of 1 the surface reflects by its specular lobe: the split sum's second factor (Karis,
// Real Shading in Unreal Engine 4). It is f0 · white + (1 − f0) · black, where both are fits to the integral of the
// lobe above with an error of at most 0.042, at grazing angles on a smooth surface (tests/render/environment_test.cpp).
vec3 specular_albedo(Surface s, float nv) {
    const float r = s.roughness, x = nv, y2 = (1.0 - x) * (1.0 - x);
    const float white = 0.96705 + r * (-0.41489 + r * (0.80682 - 0.45898 * r)) +
                        x * (0.24268 + r * (-0.38628 - 1.12013 * r) + x * (-0.0776 + 0.85959 * r - 0.14802 * x));
    const float black = y2 * (-0.35393 + r * (2.13922 - 1.93464 * r)) +
                        y2 * y2 * (1.49411 + r * (-4.7986 + 3.50087 * r)) - 0.00487 * r * r;
    return clamp(s.f0 * white + (1.0 - s.f0) * black, vec3(0.0), vec3(1.0));
}

// The ambient light reflected to the eye. `irradiance` is what a white diffuse surface would reflect, `mirrored` the
// light from the mirrored direction, blurred by roughness. The diffuse part gets what the specular lobe does not
// reflect, so that a white surface stays white.
vec3 reflect_ambient(Surface s, vec3 to_eye, vec3 irradiance, vec3 mirrored) {
    const vec3 albedo = specular_albedo(s, clamp(abs(dot(s.normal, to_eye)), 1e-4, 1.0));
    return (1.0 - albedo) * s.diffuse * irradiance + albedo * mirrored;
}

#endif
