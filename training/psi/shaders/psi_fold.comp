// Folds the output layer with the rows of one time into the head: u_k = density · Σ_c A_tc W_kc, v_k = Σ_c B_tc
// W_k(C+c), then the columns of w^HH unchanged (shared/psi.h). One thread per number of the head; little work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/psi.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kWidth = 64u;
layout(constant_id = 1) const uint kHeadColumns = 32u;
layout(binding = kPsiParameters, std430) buffer Parameters { float parameters[]; };
layout(push_constant) uniform Push { PsiFoldPush push; };
#include "psi_basis_rows.glsl"

void main() {
    const uint i = gl_GlobalInvocationID.x, k = i / kHeadColumns, column = i % kHeadColumns;
    if (k > kWidth) return;
    const uint row = push.output_offset + k * push.outputs;
    float value = 0.0;
    if (column < 2u)
        for (uint c = 0u; c < push.bases; ++c) value += row_at(column, c) * parameters[row + column * push.bases + c];
    else if (column - 2u + 2u * push.bases < push.outputs)
        value = parameters[row + 2u * push.bases + column - 2u];
    parameters[push.head_offset + i] = column == 0u ? push.density * value : value;
}
