// What the walk of an instance's ray was like, in place of light (shared/inspect.h): where it met the surface, and its steps.
// The includer binds imageBuffers `radiance` and `depth`, and has composite.glsl's `sigma`.
#ifndef NEUVV_STORE_INSPECTED_GLSL
#define NEUVV_STORE_INSPECTED_GLSL
#include "shared/inspect.h"

uint met_level = 0u;  // 0: it has not met enough yet
float met_metres;     // world

// `before`, `after`: transmittance of the solid instance.
void inspect_segment(Ray ray, MarchSegment part, float before, float after) {
    const float wanted = 1.0 - kInspectAlpha / push.box_size.w;
    if (before <= wanted || after > wanted) return;
    met_level = 2u * kNodeLevels - push.levels_above - uint(part.shift);
    met_metres = ray.world_metres * (part.t_in + log(before / wanted) / sigma);
}

void store_inspected(Ray ray, float alpha, uint steps) {
    const int at = int(ray.index);
    const vec4 there = imageLoad(radiance, at);
    const bool nearest = met_level != 0u && met_metres < imageLoad(depth, at).x;
    const float through = (1.0 - there.a) * (1.0 - push.box_size.w * alpha);
    imageStore(radiance, at, vec4(nearest ? float(met_level) : there.x, there.y + float(steps), 0.0, 1.0 - through));
    if (nearest) imageStore(depth, at, vec4(met_metres));
}

#endif
