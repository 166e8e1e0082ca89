// Prints and asserts something in every thread, for the test of the debug buffer.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "debug.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
    uint count;
    uint bad;  // the thread whose assertion fails
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    debug_print(7u, uvec4(i, floatBitsToUint(0.5 * float(i)), 0u, 0u));
    debug_assert(i != bad, 8u, uvec4(i, 1u, 2u, 3u));
}
