// A performer in a page: each pixel's ray through a slice tree, in OpenGL ES 3.0 (`build` translates it). Writes
// premultiplied sRGB. Bound by the walk, as trace_tree.comp is.
#version 460
#extension GL_GOOGLE_include_directive : require

int count_bits(uint word) {  // OpenGL ES 3.0 lacks bitCount
    word -= word >> 1u & 0x55555555u;
    word = (word & 0x33333333u) + (word >> 2u & 0x33333333u);
    return int(((word + (word >> 4u)) & 0x0f0f0f0fu) * 0x01010101u >> 24u);
}
#define bitCount count_bits

#include "arrays.glsl"
#include "shared/slice_tree.h"
#include "srgb.glsl"

layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
const bool kShaded = false, kColourless = false;

READ_ARRAY(uint, 0, tree_links);
READ_ARRAY(uvec4, 1, nodes);
READ_ARRAY(uvec2, 2, entries);

layout(push_constant) uniform Push {
    vec4 eye;  // metres; w: the transmittance below which a ray ends
    vec4 right, down, corner;  // the ray of pixel (x, y) from the top left has the direction corner + x·right + y·down
    vec4 box_min, box_size;    // metres
    vec4 background;           // linear RGB, alpha
    float height;              // of the image, pixels
    TopBox top;
    uint node_base, entry_base, shaded_stride;  // all 0: there is one slice, without shaded entries
} push;
layout(location = 0) out vec4 pixel;

#include "trace/tree_sample.glsl"
#include "trace/composite.glsl"

void main() {
    const vec2 at = vec2(gl_FragCoord.x, push.height - gl_FragCoord.y);
    const vec3 direction = normalize(push.corner.xyz + at.x * push.right.xyz + at.y * push.down.xyz);
    sample_begin(direction, 0u);
    Composite sum = composite_begin();
    March march = march_begin((push.eye.xyz - push.box_min.xyz) / push.box_size.xyz, direction / push.box_size.xyz,
                              vec2(0.0, 1e30));
    MarchInterval part;
    while (sum.transmittance >= push.eye.w && march_enter(march))
        while (sum.transmittance >= push.eye.w && march_leaf(march, part))
            composite_add(sum, sigma, part.t_out - part.t_in, sample_colour(), 0.0);
    const float alpha = 1.0 - sum.transmittance;
    const vec4 light = vec4(sum.colour, alpha) + sum.transmittance * push.background.a * vec4(push.background.rgb, 1.0);
    pixel = light.a > 0.0 ? vec4(srgb_encode(light.rgb / light.a) * light.a, light.a) : vec4(0.0);
}
