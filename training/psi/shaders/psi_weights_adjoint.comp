// Gradients of one layer's matrix, summed over a share of the samples: ∂W_ko = Σ h_k ∂z_o, ∂b_o = Σ ∂z_o. A workgroup
// sums 64 rows × 32 columns over the blocks of its split in a fixed order; each thread has 8 × 4 of them in registers.
// psi_reduce.comp adds the splits, so that the same batch always gives the same bits. Reads 4·(rows + columns) bytes
// per sample through caches for 2·rows·columns FLOP: bound by memory on a GPU.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kRows = 276u;          // of a block's activations
layout(constant_id = 1) const uint kAdjointRows = 224u;
READ_ARRAY(vec4, kPsiActivations, activations);
READ_ARRAY(vec4, kPsiAdjoints, adjoints);
layout(binding = kPsiPartials, std430) writeonly buffer Partials { float partials[]; };
layout(push_constant) uniform Push { PsiWeightsPush push; };

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    const uint column_tiles = push.outputs / 32u, split = group % push.splits, tile = group / push.splits;
    const uint k0 = tile / column_tiles * 64u + lane / 8u * 8u, o0 = tile % column_tiles * 32u + lane % 8u * 4u;
    if (tile / column_tiles * 64u >= push.inputs) return;
    vec4 sum[8], bias = vec4(0.0);  // per input row: the sums of four columns
    for (uint i = 0u; i < 8u; ++i) sum[i] = vec4(0.0);
    for (uint block = split; block < push.blocks; block += push.splits) {
        const uint h_row = block * kRows + push.input_row, z_row = block * kAdjointRows + push.output_row + o0;
        for (uint q = 0u; q < kPsiBlockTexels; ++q) {
            mat4 z;  // ∂z of four columns of the layer × four samples
            for (uint m = 0u; m < 4u; ++m) z[m] = FETCH(adjoints, int((z_row + m) * kPsiBlockTexels + q));
            for (uint i = 0u; i < 8u; ++i) {
                const uint k = min(k0 + i, push.inputs - 1u);
                sum[i] += FETCH(activations, int((h_row + k) * kPsiBlockTexels + q)) * z;
            }
            bias += vec4(1.0) * z;
        }
    }
    const uint base = split * push.partials_stride + push.matrix_offset + o0;
    for (uint i = 0u; i < 8u; ++i)
        for (uint m = 0u; m < 4u; ++m)
            if (k0 + i < push.inputs) partials[base + (k0 + i) * push.outputs + m] = sum[i][m];
    if (k0 == 0u)
        for (uint m = 0u; m < 4u; ++m) partials[base + push.inputs * push.outputs + m] = bias[m];
}
