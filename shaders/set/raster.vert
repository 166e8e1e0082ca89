// Raster: transforms a posed vertex to clip space. Reads position and normal (world, metres), UV and colour (linear).
// One invocation per vertex. Bound by fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/raster.h"

layout(location = kRasterPosition) in vec3 position;
layout(location = kRasterNormal) in vec3 normal;
layout(location = kRasterUv) in vec2 uv;
layout(location = kRasterColour) in vec4 colour;
// Centroid interpolation, because a sample outside of the triangle would read neighbouring texels of a texture atlas.
layout(location = 0) centroid out vec2 shaded_uv;
layout(location = 1) centroid out vec4 shaded_colour;
layout(location = 2) centroid out float upward;
layout(push_constant) uniform Push { RasterPush push; };

void main() {
    gl_Position = push.clip_from_world * vec4(position, 1.0);
    shaded_uv = uv;
    shaded_colour = colour;
    upward = normal.y;
}
