// Shadow catcher of the set: of a floor that is not drawn, the shadows of performers. They are black, with as much
// alpha as the shadows take of the light that a matt floor would reflect. Reads lights and shadow maps; writes
// premultiplied light and metres along the camera's axis. One invocation per texel. Bound by fetches from the maps.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/set.h"

layout(location = 0) in vec3 shaded_position;
layout(binding = kSetLights) uniform Lights { ShaderLights lights; };
READ_ARRAY(float, kSetShadowMaps, set_shadow_maps);
layout(binding = kSetPerformerShadows) uniform textureBuffer performer_shadows;
layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

#include "set/lights.glsl"
#include "set/pbr.glsl"
#include "set/shadow.glsl"

float luminance(vec3 linear) {
    return dot(linear, vec3(0.2126, 0.7152, 0.0722));
}

void main() {
    float lit = luminance(ambient_at(lights.irradiance, vec3(0.0, 1.0, 0.0))), taken = 0.0;
    for (uint i = 0u; i < lights.count; ++i) {
        vec3 to_light;
        const vec3 arriving = light_at(lights.light[i], shaded_position, to_light);
        const float reflected = luminance(arriving) * max(to_light.y, 0.0) / kPi;
        if (reflected <= 0.0) continue;
        lit += reflected;
        taken += reflected * (1.0 - performer_shadow(i, shaded_position, 0.0));
    }
    light = vec4(0.0, 0.0, 0.0, lit > 0.0 ? taken / lit : 0.0);
    metres = 1.0 / gl_FragCoord.w;
}
