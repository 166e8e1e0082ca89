// Eye shapes: controllers, rays, boxes, arcs, and holes where panels are visible; drawn as one instance per view.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
#include "shared/eye.h"

layout(location = kShapePosition) in vec3 position;
layout(location = kShapeColour) in vec4 colour;
layout(location = 0) out vec4 light;
layout(push_constant) uniform Push { ShapePush push; };

void main() {
    gl_Layer = gl_InstanceIndex;
    gl_Position = push.clip_from_world[gl_InstanceIndex & 1] * vec4(position, 1.0);
    light = colour;
}
