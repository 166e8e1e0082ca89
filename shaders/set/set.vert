// Set: transforms a posed vertex to clip space. Reads position, normal, tangent (world, metres), UVs and colour
// (linear). One invocation per vertex. Bound by fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = kRasterPosition) in vec3 position;
layout(location = kRasterNormal) in vec3 normal;
layout(location = kRasterUv) in vec2 uv;
layout(location = kRasterColour) in vec4 colour;
layout(location = kRasterTangent) in vec4 tangent;
layout(location = kRasterMapUvs) in vec4 map_uvs_a;
layout(location = kRasterMapUvs + 1u) in vec4 map_uvs_b;
layout(location = 0) out vec3 shaded_position;
layout(location = 1) out vec3 shaded_normal;
layout(location = 2) out vec4 shaded_tangent;
layout(location = 3) out vec4 shaded_colour;
layout(location = 4) out vec2 shaded_uv;
layout(location = 5) out vec4 shaded_map_uvs_a;
layout(location = 6) out vec4 shaded_map_uvs_b;
layout(push_constant) uniform Push { SetPush push; };

void main() {
    gl_Position = push.clip_from_world * vec4(position, 1.0);
    shaded_position = position;
    shaded_normal = normal;
    shaded_tangent = tangent;
    shaded_colour = colour;
    shaded_uv = uv;
    shaded_map_uvs_a = map_uvs_a;
    shaded_map_uvs_b = map_uvs_b;
}
