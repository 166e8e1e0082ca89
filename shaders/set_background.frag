// Background of the set: the environment's image where nothing stands. Reads the image; writes its light, opaque, and
// infinity. One invocation a texel; bound by texture fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) in vec3 way;
layout(binding = kSetEnvironment) uniform sampler2D environment;
layout(binding = kSetLights) uniform Lights { ShaderLights lights; };
layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

#include "environment.glsl"

void main() {
    light = vec4(min(environment_at(normalize(way), 0.0), vec3(kBrightest)), 1.0);
    metres = uintBitsToFloat(0x7f800000u);
}
