// Composites the samples of Ψ along each ray: emission and absorption, front to back, over the segments of
// psi_resample.comp. One workgroup per tile, one thread per ray. Reads 32 bytes per sample: bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = kTilePixels) in;
READ_ARRAY(vec4, kPsiPoints, points);
READ_ARRAY(vec4, kPsiValues, values);
WRITE_ARRAY(vec4, kPsiRadiance, radiance);
layout(push_constant) uniform Push { PsiBlockPush push; };
#include "trace/composite.glsl"

void main() {
    const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (tile * push.samples_per_ray >= push.blocks) return;
    Composite sum = composite_begin();
    for (uint i = 0u; i < push.samples_per_ray; ++i) {
        const int at = int((tile * push.samples_per_ray + i) * kPsiBlock + lane);
        const vec4 value = FETCH(values, at);
        composite_add(sum, value.x, FETCH(points, at).w, value.yzw, 0.0);
    }
    STORE(radiance, int(tile * kTilePixels + lane), vec4(sum.colour, 1.0 - sum.transmittance));
}
