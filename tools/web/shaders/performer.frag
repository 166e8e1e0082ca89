// A performer in a page: the ray of each pixel that the box of its leaves covers, through a slice tree, in OpenGL ES
// 3.0 (`build` translates it). Writes premultiplied light, and the mean depth from which the ray's light comes.
// Bound by the walk, as trace_tree.comp is.
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
layout(constant_id = 3) const bool kLinear = false;  // else sRGB is written
const bool kShaded = false, kColourless = false;

READ_ARRAY(uint, 0, tree_links);
READ_ARRAY(uvec4, 1, nodes);
READ_ARRAY(uvec2, 2, entries);

layout(push_constant) uniform Push {
    vec4 eye;  // metres; w = 0: rays are parallel, and come from this direction, of length 1
    // Pixel (x, y) from the bottom left is on the near plane at w·eye + corner + x·right + y·up.
    vec4 corner, right, up;
    vec4 box_min, box_size;  // metres
    vec4 background;         // linear RGB, alpha
    mat4 clip_from_tree;     // metres in the box's coordinates to gl_Position
    float stop;              // the transmittance below which a ray ends
    TopBox top;
    uint node_base, entry_base, shaded_stride;  // all 0: there is one slice, without shaded entries
} push;
layout(location = 0) out vec4 pixel;

#include "trace/tree_sample.glsl"
#include "trace/composite.glsl"

float depth_of(vec3 place) {
    const vec4 clip = push.clip_from_tree * vec4(place, 1.0);
    return clamp(0.5 * clip.z / clip.w + 0.5, 0.0, 1.0);
}

void main() {
    const vec3 at = push.corner.xyz + gl_FragCoord.x * push.right.xyz + gl_FragCoord.y * push.up.xyz;
    const bool isPerspective = push.eye.w > 0.0;
    const vec3 direction = isPerspective ? normalize(at) : -push.eye.xyz, origin = isPerspective ? push.eye.xyz : at;
    sample_begin(direction, 0u);
    Composite sum = composite_begin();
    March march = march_begin((origin - push.box_min.xyz) / push.box_size.xyz, direction / push.box_size.xyz,
                              vec2(0.0, 1e30));
    MarchInterval part;
    while (sum.transmittance >= push.stop && march_enter(march))
        while (sum.transmittance >= push.stop && march_leaf(march, part))
            composite_add(sum, sigma, part.t_out - part.t_in, sample_colour(), 0.5 * (part.t_in + part.t_out));
    const float alpha = 1.0 - sum.transmittance;
    if (alpha == 0.0) discard;
    gl_FragDepth = depth_of(origin + sum.depth / alpha * direction);
    const vec4 light = vec4(sum.colour, alpha) + sum.transmittance * push.background.a * vec4(push.background.rgb, 1.0);
    pixel = vec4(kLinear ? light.rgb : srgb_encode(light.rgb / light.a) * light.a, light.a);
}
