// Shadow catcher of the set: a triangle on the floor that covers the square of kHalf_m around push.eye, which lies on
// the floor. Writes the position (world, metres).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) out vec3 shaded_position;
layout(push_constant) uniform Push { SetPush push; };

const float kHalf_m = 30.0;

void main() {
    const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 4.0 - 1.0;
    shaded_position = push.eye.xyz + kHalf_m * vec3(corner.x, 0.0, corner.y);
    gl_Position = push.clip_from_world * vec4(shaded_position, 1.0);
}
