// The pixels of an image whose rays may meet a leaf. The includer pushes a LeafRasterPush.
#ifndef NEUVV_LEAF_PIXELS_GLSL
#define NEUVV_LEAF_PIXELS_GLSL
#include "box_pixels.glsl"
#include "leaf_key.glsl"

const float kSlack = 0.01;    // pixels, for rounding

// The first and the one after the last on each axis; none where these are equal.
struct Pixels {
    uvec2 first, end;
};

// z (x, y, 1) of the pixel that sees a place, relative to the eye
vec3 homogeneous(vec3 from_eye) {
    return vec3(dot(push.row_x.xyz, from_eye), dot(push.row_y.xyz, from_eye), dot(push.row_z.xyz, from_eye));
}

// Rays leave from pixels' centres, those of a pixel's n² from as far beside them as their shift (ray.glsl): a leaf between
// these has no pixel.
Pixels leaf_pixels(LeafCell leaf) {
    const vec3 size = push.box_size.xyz / float(1u << leaf.depth);
    const vec3 low = push.box_min.xyz + vec3(leaf.at) * size - push.eye.xyz;
    const vec2 image = vec2(push.width, push.height);
    const mat3 edges = mat3(homogeneous(vec3(size.x, 0, 0)), homogeneous(vec3(0, size.y, 0)),
                            homogeneous(vec3(0, 0, size.z)));
    vec4 covered = box_pixels(homogeneous(low), edges);
    if (length(max(max(low, -(low + size)), 0.0)) < 2.0 * kNearest) covered = vec4(0.0, 0.0, image);  // around the eye
    const float reach = 0.5 - 0.5 / push.eye.w + kSlack;
    const vec2 first = clamp(ceil(covered.xy - 0.5 - reach), vec2(0.0), image);
    const vec2 end = clamp(floor(covered.zw + 0.5 + reach), vec2(0.0), image);
    if (first.x >= end.x || first.y >= end.y) return Pixels(uvec2(0u), uvec2(0u));
    return Pixels(uvec2(first), uvec2(end));
}

#endif
