// Adds the partial sums of all splits of the samples to the gradient of each parameter of the hidden layers and the
// head, in a fixed order. One thread per parameter; reads splits × 4 bytes: bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/psi.h"

layout(local_size_x = 64) in;
layout(binding = kPsiPartials, std430) readonly buffer Partials { float partials[]; };
layout(binding = kPsiGradients, std430) writeonly buffer Gradients { float gradients[]; };
layout(push_constant) uniform Push { PsiReducePush push; };

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    float sum = 0.0;
    for (uint split = 0u; split < push.splits; ++split) sum += partials[split * push.count + i];
    gradients[i] = sum;
}
