// The light of a stage's lights at a position. The functions take their data as arguments and read no buffer, so that
// graphics and compute shaders share them.
#ifndef NEUVV_LIGHTS_GLSL
#define NEUVV_LIGHTS_GLSL
#include "shared/lights.h"

// KHR_lights_punctual: the light on a surface that faces the light, without shadows, in lux; `to_light` is unit.
//   point, spot: intensity / d² · max(1 − (d / range)⁴, 0);   spot: · clamp(cos · scale + offset)²
vec3 light_at(ShaderLight light, vec3 world, out vec3 to_light) {
    to_light = -light.direction.xyz;
    if (light.kind == kLightDirectional) return light.colour.rgb;
    const vec3 offset = light.position.xyz - world;
    const float square = max(dot(offset, offset), kNearestLight * kNearestLight);
    to_light = offset * inversesqrt(square);
    float share = 1.0 / square;
    if (light.position.w > 0.0) {
        const float ratio = square / (light.position.w * light.position.w);
        share *= max(1.0 - ratio * ratio, 0.0);
    }
    if (light.kind == kLightSpot) {
        const float cone = dot(light.direction.xyz, -to_light) * light.cone_scale + light.cone_offset;
        share *= clamp(cone, 0.0, 1.0) * clamp(cone, 0.0, 1.0);
    }
    return light.colour.rgb * share;
}

// The ambient light that a white diffuse surface with the normal `n` reflects, a sum of nine SH functions (Ramamoorthi
// and Hanrahan 2001); `irradiance` is that of ShaderLights.
vec3 ambient_at(vec4 irradiance[9], vec3 n) {
    return max(irradiance[0].rgb + irradiance[1].rgb * n.y + irradiance[2].rgb * n.z + irradiance[3].rgb * n.x +
                   irradiance[4].rgb * (n.x * n.y) + irradiance[5].rgb * (n.y * n.z) +
                   irradiance[6].rgb * (3.0 * n.z * n.z - 1.0) + irradiance[7].rgb * (n.x * n.z) +
                   irradiance[8].rgb * (n.x * n.x - n.y * n.y),
               vec3(0.0));
}

#endif
