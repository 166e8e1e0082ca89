// Background of the set: one triangle over the whole view, infinitely far. Writes the way of its rays (world, not unit).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) out vec3 way;
layout(push_constant) uniform Push { SetPush push; };

void main() {
    const vec2 place = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 0.0, 1.0);
    way = (push.clip_from_world * gl_Position).xyz;  // depth 0 is infinity: a direction
}
