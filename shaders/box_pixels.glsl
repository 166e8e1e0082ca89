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

// The smallest (xy) and largest (zw) pixel coordinates of the part of a box that lies before the eye; x > z where there
// is none. The box is given by its low corner, relative to the eye, and its edges, each as z (x, y, 1) for the pixel
// (x, y) onto which it is projected.
vec4 box_pixels(vec3 low, mat3 edges) {
    vec4 bounds = vec4(1e30, 1e30, -1e30, -1e30);
    bool behind = false;
    for (uint i = 0u; i < 8u; i++) {
        const vec3 corner = low + edges * vec3(i & 1u, i >> 1u & 1u, i >> 2u);
        const bool before = corner.z >= kNearest;
        const vec2 pixel = corner.xy / corner.z;
        if (before) bounds = vec4(min(bounds.xy, pixel), max(bounds.zw, pixel));
        behind = behind || !before;
    }
    if (!behind || bounds.x > bounds.z) return bounds;
    for (uint i = 0u; i < 8u; i++) {
        const vec3 corner = low + edges * vec3(i & 1u, i >> 1u & 1u, i >> 2u);
        for (uint axis = 0u; axis < 3u; axis++)
            if ((i >> axis & 1u) == 0u) add_cut(bounds, corner, corner + edges[axis]);
    }
    return bounds;
}

#endif
