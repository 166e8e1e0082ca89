// Background of the set: one triangle over the whole view, infinitely far. Writes the direction of rays (world, not
// unit).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) out vec3 direction;
layout(push_constant) uniform Push { SetPush push; };

void main() {
    const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 4.0 - 1.0;
    gl_Position = vec4(corner, 0.0, 1.0);
    direction = (push.clip_from_world * gl_Position).xyz;  // depth 0 is infinitely far, so this is a direction
}
