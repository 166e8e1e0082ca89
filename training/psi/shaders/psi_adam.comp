// Moves the parameters of Ψ by Adam: hidden layers, output layer, A and B. One thread per parameter; reads 16 bytes and
// writes 12: bound by memory, but the whole network has only about 100 KB.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/psi.h"
#include "shared/training.h"

layout(local_size_x = 64) in;
layout(binding = kPsiParameters, std430) buffer Parameters { float parameters[]; };
layout(binding = kPsiGradients, std430) readonly buffer Gradients { float gradients[]; };
layout(binding = kPsiFirstMoments, std430) buffer First { float first[]; };
layout(binding = kPsiSecondMoments, std430) buffer Second { float second[]; };
layout(push_constant) uniform Push { PsiAdamPush push; };
#include "../../shaders/adam.glsl"

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count || push.emit != 0u || (i >= push.head_offset && i < push.output_offset)) return;
    const AdamPush adam = AdamPush(push.beta1, push.beta2, push.epsilon, push.bias1, push.bias2, 0u);
    const AdamElement new =
        adam_update(AdamElement(vec4(parameters[i]), vec4(first[i]), vec4(second[i])), vec4(gradients[i]),
                    i < push.sigma_rows_offset ? push.rate : push.rows_rate, adam);
    parameters[i] = new.weight.x;
    first[i] = new.first.x;
    second[i] = new.second.x;
}
