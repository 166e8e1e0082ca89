// The adjoint of psi_composite.comp: takes ∂L/∂ray to ∂L/∂(σ, c) of every sample. One workgroup per tile, one thread
// per ray. Reads 32 bytes per sample and writes 16: bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = kTilePixels) in;
READ_ARRAY(vec4, kPsiPoints, points);
READ_ARRAY(vec4, kPsiValues, values);
READ_ARRAY(vec4, kPsiRadiance, radiance);
READ_ARRAY(vec4, kPsiRayAdjoints, ray_adjoints);
WRITE_ARRAY(vec4, kPsiValueAdjoints, value_adjoints);
layout(push_constant) uniform Push { PsiBlockPush push; };
#include "trace/composite.glsl"

void main() {
    const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (tile * push.samples_per_ray >= push.blocks) return;
    const int ray = int(tile * kTilePixels + lane);
    const vec4 d_ray = FETCH(ray_adjoints, ray), traced = FETCH(radiance, ray);
    const Composite whole = Composite(traced.rgb, 1.0 - traced.a, 0.0);
    Composite sum = composite_begin();
    for (uint i = 0u; i < push.samples_per_ray; ++i) {
        const int at = int((tile * push.samples_per_ray + i) * kPsiBlock + lane);
        const vec4 value = FETCH(values, at);
        const float delta = FETCH(points, at).w;
        const float weight = composite_add(sum, value.x, delta, value.yzw, 0.0);
        STORE(value_adjoints, at,
              vec4(composite_adjoint(sum, whole, delta, value.yzw, d_ray.rgb, d_ray.a), weight * d_ray.rgb));
    }
}
