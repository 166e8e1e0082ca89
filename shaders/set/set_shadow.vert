// Shadow of the set: projects a posed vertex into the light's shadow map. One invocation per vertex. Bound by fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = kRasterPosition) in vec3 position;
layout(location = kRasterUv) in vec2 uv;
layout(location = kRasterColour) in vec4 colour;
layout(location = 0) out vec2 shaded_uv;
layout(location = 1) out float shaded_alpha;
layout(push_constant) uniform Push { SetPush push; };

void main() {
    gl_Position = push.clip_from_world * vec4(position, 1.0);
    shaded_uv = uv;
    shaded_alpha = colour.a;
}
