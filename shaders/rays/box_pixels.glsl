// The pixels that a box covers.
#ifndef NEUVV_BOX_PIXELS_GLSL
#define NEUVV_BOX_PIXELS_GLSL

const float kNearest = 1e-3;  // metres before the eye's plane: boxes that extend behind it are cut there

// Extends `bounds` by the pixel coordinates of the point where the edge from a to b crosses kNearest, if it does.
void add_cut(inout vec4 bounds, vec3 a, vec3 b) {
    if ((a.z < kNearest) == (b.z < kNearest)) return;
    const vec2 cut = mix(a, b, (kNearest - a.z) / (b.z - a.z)).xy / kNearest;
    bounds = vec4(min(bounds.xy, cut), max(bounds.zw, cut));
}

// Bounds of a box, all of which lies at least `nearest` before the eye: relative to the pixel p of its centre, the box
// is (xy − p z) / z, and numerator and z each have their bounds at corners. A little too large where z differs much.
vec4 whole_box_pixels(vec3 low, mat3 edges, float nearest) {
    const vec3 centre = low + 0.5 * (edges[0] + edges[1] + edges[2]);
    const vec2 p = centre.xy / centre.z;
    vec2 first = low.xy - p * low.z, last = first;
    for (uint axis = 0u; axis < 3u; ++axis) {
        const vec2 edge = edges[axis].xy - p * edges[axis].z;
        first += min(edge, 0.0);
        last += max(edge, 0.0);
    }
    return vec4(p + min(first, 0.0) / nearest, p + max(last, 0.0) / nearest);
}

// The smallest (xy) and largest (zw) pixel coordinates of the part of a box that lies before the eye; x > z where there
// is none. The box is given by its low corner, relative to the eye, and its edges, each as z (x, y, 1) for the pixel
// (x, y) onto which it is projected.
vec4 box_pixels(vec3 low, mat3 edges) {
    const float nearest = low.z + min(edges[0].z, 0.0) + min(edges[1].z, 0.0) + min(edges[2].z, 0.0);
    if (nearest >= kNearest) return whole_box_pixels(low, edges, nearest);
    vec4 bounds = vec4(1e30, 1e30, -1e30, -1e30);
    // Where all lanes have returned, lavapipe leaves this loop after one round; without the condition it runs all
    // eight.
    for (uint i = nearest < kNearest ? 0u : 8u; i < 8u; ++i) {
        const vec3 corner = low + edges * vec3(i & 1u, i >> 1u & 1u, i >> 2u);
        if (corner.z >= kNearest) {
            const vec2 pixel = corner.xy / corner.z;
            bounds = vec4(min(bounds.xy, pixel), max(bounds.zw, pixel));
        }
        for (uint axis = 0u; axis < 3u; ++axis)
            if ((i >> axis & 1u) == 0u) add_cut(bounds, corner, corner + edges[axis]);
    }
    return bounds;
}

#endif
