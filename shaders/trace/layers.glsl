// Blends layers of instances with what is stored for a ray. The includer declares the arrays `radiance` and `depth`.
#ifndef NEUVV_LAYERS_GLSL
#define NEUVV_LAYERS_GLSL
#include "arrays.glsl"

// Blends a layer under what is stored; the depth becomes that of both together (errata 12).
void store_under(int ray, vec4 light, float distance_m) {
    const vec4 stored = LOAD(radiance, ray);
    const float weight = (1.0 - stored.a) * light.a, alpha = stored.a + weight;
    if (weight <= 0.0) return;
    const float stored_metres = stored.a > 0.0 ? LOAD(depth, ray).x : 0.0;
    STORE(radiance, ray, stored + (1.0 - stored.a) * light);
    STORE(depth, ray, vec4((stored.a * stored_metres + weight * distance_m) / alpha));
}

// The paper's Algorithm 1 (errata 11): the nearer layer goes over the farther one.
void store_by_depth(int ray, vec4 light, float distance_m) {
    const vec4 stored = LOAD(radiance, ray);
    const float stored_metres = LOAD(depth, ray).x;
    const bool nearer = distance_m <= stored_metres;
    STORE(radiance, ray, nearer ? light + (1.0 - light.a) * stored : stored + (1.0 - stored.a) * light);
    STORE(depth, ray, vec4(min(distance_m, stored_metres)));
}

#endif
