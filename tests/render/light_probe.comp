// lights.glsl and shadow.glsl as a compute shader uses them: one thread a place, all lights.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "../../tests/render/light_probe.h"

layout(local_size_x = 64) in;
layout(binding = kProbePlaces) uniform textureBuffer places;
layout(binding = kProbeLights) uniform Lights { ShaderLights lights; };
layout(binding = kProbeSetShadows) uniform textureBuffer set_shadow_maps;
layout(binding = kProbePerformerShadows) uniform textureBuffer performer_shadows;
layout(binding = kProbeOut, rgba32f) writeonly uniform imageBuffer results;
layout(push_constant) uniform Push { LightProbePush push; };

#include "lights.glsl"
#include "shadow.glsl"

void main() {
    const uint place = gl_GlobalInvocationID.x;
    if (place >= push.places) return;
    const vec3 world = texelFetch(places, int(place)).xyz;
    for (uint i = 0u; i < lights.count; i++) {
        vec3 to_light;
        const vec3 light = light_at(lights.light[i], world, to_light);
        const int at = int(2u * (place * lights.count + i));
        imageStore(results, at, vec4(light, set_shadow(i, world, vec3(0.0))));
        imageStore(results, at + 1, vec4(to_light, performer_shadow(i, world, 0.0)));
    }
}
