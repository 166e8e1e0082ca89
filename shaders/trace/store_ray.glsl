// Stores a ray's result where a field is traced alone (trace_rays.glsl).
#ifndef NEUVV_STORE_RAY_GLSL
#define NEUVV_STORE_RAY_GLSL
#include "arrays.glsl"

bool is_hidden(Ray ray) { return false; }

void store_interval(Ray ray, MarchInterval part, float before, float after, vec3 colour) {}

void store_ray(Ray ray, vec4 light, float metres, uint steps) {
    STORE(radiance, int(ray.index), light);
    STORE(depth, int(ray.index), vec4(metres));
}

#endif
