// Raster: the base colour of glTF (factor × vertex colour × texture), linear and premultiplied. There are no lights:
// unlit materials have their plain colour, others are lit by a soft sky. One invocation per fragment. Bound by texture
// fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/raster.h"

layout(location = 0) centroid in vec2 shaded_uv;
layout(location = 1) centroid in vec4 shaded_colour;
layout(location = 2) centroid in float upward;
layout(binding = kRasterTexture) uniform sampler2D base_texture;
layout(push_constant) uniform Push { RasterPush push; };
layout(location = 0) out vec4 light;

void main() {
    const vec4 colour = push.base_colour * shaded_colour * texture(base_texture, shaded_uv);
    if (colour.a < push.alpha_cutoff) discard;
    const float facing = gl_FrontFacing ? upward : -upward;
    const float sky = 1.0 - push.sky * (0.5 - 0.5 * facing);
    const float alpha = mix(clamp(colour.a, 0.0, 1.0), 1.0, push.opaque);
    light = vec4(colour.rgb * sky * alpha, alpha);
}
