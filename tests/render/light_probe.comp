// Evaluates lights.glsl and shadow.glsl in a compute shader, for all lights at each position; one thread per position.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "../../tests/render/light_probe.h"

layout(local_size_x = 64) in;
layout(binding = kProbePositions) uniform textureBuffer positions;
layout(binding = kProbeLights) uniform Lights { ShaderLights lights; };
layout(binding = kProbeSetShadows) uniform textureBuffer set_shadow_maps;
layout(binding = kProbePerformerShadows) uniform textureBuffer performer_shadows;
layout(binding = kProbeOut, rgba32f) writeonly uniform imageBuffer results;
layout(push_constant) uniform Push { LightProbePush push; };

#include "set/lights.glsl"
#include "set/shadow.glsl"

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= push.positions) return;
    const vec3 world = texelFetch(positions, int(index)).xyz;
    for (uint i = 0u; i < lights.count; ++i) {
        vec3 to_light;
        const vec3 light = light_at(lights.light[i], world, to_light);
        const int at = int(2u * (index * lights.count + i));
        imageStore(results, at, vec4(light, set_shadow(i, world, vec3(0.0))));
        imageStore(results, at + 1, vec4(to_light, performer_shadow(i, world, 0.0)));
    }
}
