// Ψ at a block of 64 samples: encoding → kLayers hidden layers → head (shared/psi.h) → σ and colour. One workgroup per
// block; all layers are computed in shared memory. Reads 16 bytes per sample, and directions of rays; writes 16 bytes
// per sample, and where the adjoint follows 4 bytes per row and sample of activations (1 KiB per sample at width 64 and
// 3 layers). Bound by arithmetic: 2·(inputs·width + (layers−1)·width² + width·head columns) FLOP per sample; that is 27
// k with 52 inputs, width 64, 3 layers and 32 columns.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = kPsiBlock) in;
layout(constant_id = 0) const uint kFrequencies = 8u;
layout(constant_id = 1) const uint kInputs = 52u;
layout(constant_id = 2) const uint kWidth = 64u;
layout(constant_id = 3) const uint kLayers = 3u;
layout(constant_id = 4) const uint kHhDegree = 1u;
layout(constant_id = 5) const uint kHeadColumns = 32u;
READ_ARRAY(vec4, kPsiPoints, points);
READ_ARRAY(vec4, kPsiDirections, directions);
READ_ARRAY(vec4, kPsiParameters, parameters);
WRITE_ARRAY(vec4, kPsiActivations, activations);
WRITE_ARRAY(vec4, kPsiValues, values);
layout(push_constant) uniform Push { PsiBlockPush push; };
#include "psi_layer.glsl"
#include "psi_head.glsl"
#include "psi_encode.glsl"

// Writes `rows` rows from shared memory into the activations, beginning with row `first_row`.
void keep_rows(uint rows, uint first_row) {
    for (uint i = gl_LocalInvocationID.x; i < rows * kPsiBlockTexels; i += kPsiBlock)
        STORE(activations, int(first_row * kPsiBlockTexels + i), act[i]);
}

void main() {
    const uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (block >= push.blocks) return;
    const uint base = block * psi_activation_rows(kInputs, kWidth, kLayers, kHeadColumns);
    encode(FETCH(points, int(block * kPsiBlock + lane)).xyz);
    barrier();
    if (push.keep == kPsiKeepAll) keep_rows(kInputs, base);
    for (uint layer = 0u; layer < kLayers; ++layer) {
        layer_forward(layer == 0u ? kInputs : kWidth, psi_layer_offset(layer, kInputs, kWidth) / 4u, kWidth / 4u, true);
        if (push.keep == kPsiKeepAll) keep_rows(kWidth, base + kInputs + layer * kWidth);
    }
    if (push.keep == kPsiKeepHidden) {
        keep_rows(kWidth, block * kWidth);
        return;
    }
    layer_forward(kWidth, psi_layer_offset(kLayers, kInputs, kWidth) / 4u, kHeadColumns / 4u, false);
    if (push.keep == kPsiKeepAll) keep_rows(kHeadColumns, base + kInputs + kLayers * kWidth);
    vec3 colour = vec3(0.0);
    if (push.keep == kPsiKeepAll)
        colour = head_colour(head_gamma(),
                             FETCH(directions, int(block / push.samples_per_ray * kPsiBlock + lane)).xyz);
    STORE(values, int(block * kPsiBlock + lane), vec4(max(act_of_sample(0u), 0.0), colour));
}
