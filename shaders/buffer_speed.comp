// Buffer speed: reads long arrays as a frame does, so that a device's profiles can be timed. A thread reads four fp16
// weights from each of several planes, as a slice does, and then follows entries, each of which names the next, as a
// ray does.
// Reads weights and entries; writes nothing, but compilers cannot know that. One thread per leaf and ray. Bound by
// memory and its latency.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/buffer_speed.h"

layout(local_size_x = kSpeedGroup) in;
READ_ARRAY(half4, kSpeedWeights, weights);
READ_ARRAY(uvec2, kSpeedEntries, entries);
layout(binding = kSpeedOut, std430) writeonly buffer Out { vec4 result; };

void main() {
    const uint thread = gl_GlobalInvocationID.x;
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < kSpeedReads; ++i)
        sum += FETCH(weights, int((thread + i * (kSpeedElements / kSpeedReads)) % kSpeedElements));
    uvec2 entry = uvec2(thread % kSpeedElements);
    for (uint i = 0u; i < kSpeedReads; ++i) entry = FETCH(entries, int(entry.x)).xy;
    if (entry.y == kSpeedElements) result = sum;  // no entry has that
}
