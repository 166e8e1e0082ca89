// Background of the set: the environment, where no piece of the set is visible. Reads the environment's image; writes
// its light, opaque, and an infinite distance. One invocation per texel. Bound by texture fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) in vec3 direction;
layout(binding = kSetEnvironment) uniform sampler2D environment;
layout(binding = kSetLights) uniform Lights { ShaderLights lights; };
layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

#include "set/environment.glsl"

void main() {
    light = vec4(min(environment_at(normalize(direction), 0.0), vec3(kBrightest)), 1.0);
    metres = uintBitsToFloat(0x7f800000u);
}
