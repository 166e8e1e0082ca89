// Layers of instances into the rays' buffers. The includer binds imageBuffers `radiance` and `depth`.
#ifndef NEUVV_LAYERS_GLSL
#define NEUVV_LAYERS_GLSL

// Under all that stands there; depth stays that of the whole ray (errata 12).
void store_under(int ray, vec4 light, float world_metres) {
    const vec4 there = imageLoad(radiance, ray);
    const float weight = (1.0 - there.a) * light.a, alpha = there.a + weight;
    if (weight <= 0.0) return;
    const float there_metres = there.a > 0.0 ? imageLoad(depth, ray).x : 0.0;
    imageStore(radiance, ray, there + (1.0 - there.a) * light);
    imageStore(depth, ray, vec4((there.a * there_metres + weight * world_metres) / alpha));
}

// The paper's Algorithm 1 (errata 11): the nearer layer over the farther one.
void store_by_depth(int ray, vec4 light, float world_metres) {
    const vec4 there = imageLoad(radiance, ray);
    const float there_metres = imageLoad(depth, ray).x;
    const bool nearer = world_metres <= there_metres;
    imageStore(radiance, ray, nearer ? light + (1.0 - light.a) * there : there + (1.0 - there.a) * light);
    imageStore(depth, ray, vec4(min(world_metres, there_metres)));
}

#endif
