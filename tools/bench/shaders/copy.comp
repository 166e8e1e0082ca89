// Copy: a buffer to another, as the measure of the device's memory. Bound by memory, 16 bytes read and written a
// thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/copy.h"

layout(local_size_x = kCopyGroup) in;
layout(binding = kCopyFrom, std430) readonly buffer From { vec4 from[]; };
layout(binding = kCopyTo, std430) writeonly buffer To { vec4 to[]; };
layout(push_constant) uniform Push { CopyPush push; };

void main() {
    const uint first = gl_WorkGroupID.x * kCopyGroup * kCopyOfThread + gl_LocalInvocationID.x;
    for (uint i = 0u; i < kCopyOfThread; ++i) {
        const uint at = first + i * kCopyGroup;
        if (at < push.vectors) to[at] = from[at];
    }
}
