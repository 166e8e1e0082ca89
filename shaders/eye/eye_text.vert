// Eye text: rectangles that show parts of a font's image, drawn as one instance per view.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
#include "shared/eye.h"

layout(location = kTextPosition) in vec3 position;
layout(location = kTextColour) in vec4 colour;
layout(location = kTextUv) in vec2 uv;
layout(location = 0) out vec4 light;
layout(location = 1) out vec2 font_uv;
layout(push_constant) uniform Push { ShapePush push; };

void main() {
    gl_Layer = gl_InstanceIndex;
    gl_Position = push.clip_from_world[gl_InstanceIndex & 1] * vec4(position, 1.0);
    light = colour;
    font_uv = uv;
}
