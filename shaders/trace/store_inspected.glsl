// Stores statistics of a ray's walk through an instance in place of light (shared/inspect.h): the leaf where the ray
// met the surface, and the steps of the walk. The includer declares the arrays `radiance` and `depth`, and has `sigma`
// of the leaf that the walk stopped at.
#ifndef NEUVV_STORE_INSPECTED_GLSL
#define NEUVV_STORE_INSPECTED_GLSL
#include "arrays.glsl"
#include "shared/inspect.h"

uint met_level = 0u;  // 0: alpha has not exceeded kInspectAlpha yet
float met_metres;     // world

// `before` and `after` are the transmittance before and after the interval, for an instance of opacity 1.
void inspect_interval(Ray ray, MarchInterval part, float before, float after) {
    const float threshold = 1.0 - kInspectAlpha / push.box_size.w;
    if (before <= threshold || after > threshold) return;
    met_level = 2u * kNodeLevels - push.levels_above - uint(part.shift);
    met_metres = ray.world_metres * (part.t_in + log(before / threshold) / sigma);
}

void store_inspected(Ray ray, float alpha, uint steps) {
    const int at = int(ray.index);
    const vec4 stored = LOAD(radiance, at);
    const bool nearest = met_level != 0u && met_metres < LOAD(depth, at).x;
    const float through = (1.0 - stored.a) * (1.0 - push.box_size.w * alpha);
    STORE(radiance, at, vec4(nearest ? float(met_level) : stored.x, stored.y + float(steps), 0.0, 1.0 - through));
    if (nearest) STORE(depth, at, vec4(met_metres));
}

#endif
