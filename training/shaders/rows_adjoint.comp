// Moves the rows A_t and B_t by the sum of the gradients that all leaves give them; a fractional frame moves two rows
// of each basis (errata 9). Reads the partial sums of slice_adjoint.comp, in a fixed order. One workgroup, one thread
// per column of both bases; little work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/training.h"

layout(local_size_x = 2 * kMaxBases) in;
layout(binding = kRowsAdjointPartials, std430) readonly buffer Partials { float partials[]; };
layout(binding = kRowsAdjointCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kRowsAdjointSigma, r32f) uniform imageBuffer sigma_basis;
layout(binding = kRowsAdjointGamma, r32f) uniform imageBuffer gamma_basis;
layout(binding = kRowsAdjointFirstMoments, r32f) uniform imageBuffer first;
layout(binding = kRowsAdjointSecondMoments, r32f) uniform imageBuffer second;
layout(push_constant) uniform Push { RowsAdjointPush push; };
#include "adam.glsl"

// Moves one element of A or B. The moments of B follow those of A.
void move_element(bool is_gamma, uint row, uint column, float gradient) {
    const int at = int(row * push.bases + column);
    const int moment = at + (is_gamma ? int(push.frames * push.bases) : 0);
    const float weight = is_gamma ? imageLoad(gamma_basis, at).x : imageLoad(sigma_basis, at).x;
    const AdamElement old =
        AdamElement(vec4(weight), vec4(imageLoad(first, moment).x), vec4(imageLoad(second, moment).x));
    const AdamElement new =
        adam_update(old, vec4(gradient), is_gamma ? push.gamma_rate : push.sigma_rate, push.adam);
    if (is_gamma)
        imageStore(gamma_basis, at, new.weight);
    else
        imageStore(sigma_basis, at, new.weight);
    imageStore(first, moment, new.first);
    imageStore(second, moment, new.second);
}

void main() {
    const uint lane = gl_LocalInvocationID.x, column = lane % kMaxBases;
    if (column >= push.bases) return;
    float gradient = 0.0;
    for (uint group = 0u; group < count.groups_x; group++) gradient += partials[group * (2u * kMaxBases) + lane];
    const float frame = clamp(push.frame, 0.0, float(push.frames - 1u));
    const uint before = min(uint(frame), push.frames - 1u);
    const float part = frame - float(before);
    move_element(lane >= kMaxBases, before, column, (1.0 - part) * gradient);
    if (part > 0.0) move_element(lane >= kMaxBases, before + 1u, column, part * gradient);
}
