// Eye shapes: controllers, rays, boxes, arcs, and holes where panels show; an instance an eye.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
#include "shared/eye.h"

layout(location = kShapePlace) in vec3 place;
layout(location = kShapeColour) in vec4 colour;
layout(location = 0) out vec4 light;
layout(push_constant) uniform Push { ShapePush push; };

void main() {
    gl_Layer = gl_InstanceIndex;
    gl_Position = push.clip_from_world[gl_InstanceIndex] * vec4(place, 1.0);
    light = colour;
}
