// The pixels of an image whose rays may meet a leaf. The file that includes this one declares a LeafRasterPush `push`.
#ifndef NEUVV_LEAF_PIXELS_GLSL
#define NEUVV_LEAF_PIXELS_GLSL
#include "rays/box_pixels.glsl"
#include "leaf_key.glsl"

const float kSlack = 0.01;  // pixels, for rounding

// The first pixel and the one after the last, on each axis; no pixels where they are equal.
struct Pixels {
    uvec2 first, end;
};

// z · (x, y, 1), where (x, y) is the pixel that sees a point, and z its depth. `from_eye`: the point relative to the
// eye.
vec3 homogeneous(vec3 from_eye) {
    return vec3(dot(push.row_x.xyz, from_eye), dot(push.row_y.xyz, from_eye), dot(push.row_z.xyz, from_eye));
}

// A pixel has one ray from its centre, or n² rays that are shifted from it (ray.glsl). A leaf that lies between rays
// has no pixel.
Pixels leaf_pixels(LeafCell leaf) {
    const vec3 size = push.box_size.xyz / float(1u << leaf.depth);
    const vec3 low = push.box_min.xyz + vec3(leaf.at) * size - push.eye.xyz;
    const vec2 image = vec2(push.width, push.height);
    const mat3 edges = mat3(homogeneous(vec3(size.x, 0, 0)), homogeneous(vec3(0, size.y, 0)),
                            homogeneous(vec3(0, 0, size.z)));
    vec4 covered = box_pixels(homogeneous(low), edges);
    const bool around_eye = length(max(max(low, -(low + size)), 0.0)) < 2.0 * kNearest;  // or nearly
    if (around_eye) covered = vec4(0.0, 0.0, image);
    const float margin = 0.5 - 0.5 / push.eye.w + kSlack;
    const vec2 first = clamp(ceil(covered.xy - 0.5 - margin), vec2(0.0), image);
    const vec2 end = clamp(floor(covered.zw + 0.5 + margin), vec2(0.0), image);
    if (first.x >= end.x || first.y >= end.y) return Pixels(uvec2(0u), uvec2(0u));
    return Pixels(uvec2(first), uvec2(end));
}

#endif
