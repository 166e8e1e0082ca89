// The adjoint of Ψ at a block of 64 samples: ∂L/∂(σ, c) → head → hidden layers. Writes ∂L/∂z of every layer for
// psi_weights_adjoint.comp. One workgroup per block, which works in shared memory. Reads and writes 4 bytes per row and
// sample (1.7 KiB per sample at width 64 and 3 layers); bound by arithmetic, 2·((layers−1)·width² + width·head columns)
// FLOP per sample.
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
READ_ARRAY(vec4, kPsiDirections, directions);
READ_ARRAY(vec4, kPsiParameters, parameters);
READ_ARRAY(vec4, kPsiActivations, activations);
WRITE_ARRAY(vec4, kPsiAdjoints, adjoints);
READ_ARRAY(vec4, kPsiValues, values);
READ_ARRAY(vec4, kPsiValueAdjoints, value_adjoints);
layout(push_constant) uniform Push { PsiBlockPush push; };
#include "psi_layer.glsl"
#include "psi_head.glsl"

// Writes `rows` rows from shared memory into the adjoints, beginning with row `first_row`.
void write_rows(uint rows, uint first_row) {
    for (uint i = gl_LocalInvocationID.x; i < rows * kPsiBlockTexels; i += kPsiBlock)
        STORE(adjoints, int(first_row * kPsiBlockTexels + i), act[i]);
}

// The adjoint of relu: ∂z = ∂h where h > 0, else 0. `first_row`: the first row of h among the activations.
void relu_adjoint(uint first_row) {
    for (uint i = gl_LocalInvocationID.x; i < kWidth * kPsiBlockTexels; i += kPsiBlock) {
        const vec4 h = FETCH(activations, int(first_row * kPsiBlockTexels + i));
        act[i] = mix(vec4(0.0), act[i], greaterThan(h, vec4(0.0)));
    }
    barrier();
}

void main() {
    const uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (block >= push.blocks) return;
    const uint base = block * psi_activation_rows(kInputs, kWidth, kLayers, kHeadColumns);
    const uint out_base = block * psi_adjoint_rows(kWidth, kLayers, kHeadColumns);
    const uint head_row = base + kInputs + kLayers * kWidth;
    for (uint i = lane; i < kHeadColumns * kPsiBlockTexels; i += kPsiBlock)
        act[i] = FETCH(activations, int(head_row * kPsiBlockTexels + i));
    barrier();
    const int at = int(block * kPsiBlock + lane);
    const vec4 d_value = FETCH(value_adjoints, at);
    const vec3 direction = FETCH(directions, int(block / push.samples_per_ray * kPsiBlock + lane)).xyz;
    head_adjoint(direction, FETCH(values, at).yzw, d_value.x, d_value.yzw, push.revival);
    barrier();
    write_rows(kHeadColumns, out_base + kLayers * kWidth);
    layer_adjoint(psi_layer_offset(kLayers, kInputs, kWidth) / 4u, kHeadColumns / 4u);
    for (uint layer = kLayers; layer-- > 0u;) {
        relu_adjoint(base + kInputs + layer * kWidth);
        write_rows(kWidth, out_base + layer * kWidth);
        if (layer > 0u) layer_adjoint(psi_layer_offset(layer, kInputs, kWidth) / 4u, kWidth / 4u);
    }
}
