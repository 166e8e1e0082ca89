// The adjoint of psi_fold.comp: takes gradients of the head to those of output layer, A and B:
//   ∂W_kc = density · A_tc ∂u_k,  ∂A_tc = density · Σ_k W_kc ∂u_k,  and the same for B with v, without the density;
// rows of other frames get 0. One thread per parameter from the output layer on; little work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/psi.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kWidth = 64u;
layout(constant_id = 1) const uint kHeadColumns = 32u;
layout(binding = kPsiParameters, std430) readonly buffer Parameters { float parameters[]; };
layout(binding = kPsiGradients, std430) buffer Gradients { float gradients[]; };
layout(push_constant) uniform Push { PsiFoldPush push; };
#include "psi_basis_rows.glsl"

float scale(uint kind) { return kind == 0u ? push.density : 1.0; }

float output_gradient(uint k, uint column) {
    const uint head = push.head_offset + k * kHeadColumns;
    if (column >= 2u * push.bases) return gradients[head + 2u + column - 2u * push.bases];
    const uint kind = column / push.bases;
    return scale(kind) * row_at(kind, column % push.bases) * gradients[head + kind];
}

float row_gradient(uint kind, uint row, uint c) {
    const float share = row_share(row);
    if (share == 0.0) return 0.0;
    float sum = 0.0;
    for (uint k = 0u; k <= kWidth; ++k)
        sum += parameters[push.output_offset + k * push.outputs + kind * push.bases + c] *
               gradients[push.head_offset + k * kHeadColumns + kind];
    return share * scale(kind) * sum;
}

void main() {
    const uint i = push.output_offset + gl_GlobalInvocationID.x, per_basis = push.frames * push.bases;
    if (i >= push.sigma_rows_offset + 2u * per_basis) return;
    if (i < push.sigma_rows_offset) {
        const uint at = i - push.output_offset;
        gradients[i] = output_gradient(at / push.outputs, at % push.outputs);
        return;
    }
    const uint element = i - push.sigma_rows_offset, kind = element / per_basis;
    gradients[i] = row_gradient(kind, element % per_basis / push.bases, element % push.bases);
}
