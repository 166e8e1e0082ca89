// Moves the rows A_t and B_t by the sum of the gradients that all leaves give them; a fractional frame moves two rows
// of each basis (errata 9). Reads the partial sums of slice_adjoint.comp, in a fixed order. One workgroup, one thread
// per column of both bases; little work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"
#include "slice/temporal_basis.glsl"

layout(local_size_x = 2 * kMaxBases) in;
layout(binding = kRowsAdjointPartials, std430) readonly buffer Partials { float partials[]; };
layout(binding = kRowsAdjointCount, std430) readonly buffer Count { LiveCount count; };
UPDATE_ARRAY(float, kRowsAdjointSigma, sigma_basis);
UPDATE_ARRAY(float, kRowsAdjointGamma, gamma_basis);
UPDATE_ARRAY(float, kRowsAdjointFirstMoments, first);
UPDATE_ARRAY(float, kRowsAdjointSecondMoments, second);
layout(push_constant) uniform Push { RowsAdjointPush push; };
#include "adam.glsl"

// Moves one element of A or B. The moments of B follow those of A.
void move_element(bool is_gamma, uint row, uint column, float gradient) {
    const int at = int(row * push.bases + column);
    const int moment = at + (is_gamma ? int(push.frames * push.bases) : 0);
    const float weight = is_gamma ? LOAD(gamma_basis, at).x : LOAD(sigma_basis, at).x;
    const AdamElement old =
        AdamElement(vec4(weight), vec4(LOAD(first, moment).x), vec4(LOAD(second, moment).x));
    const AdamElement new =
        adam_update(old, vec4(gradient), is_gamma ? push.gamma_rate : push.sigma_rate, push.adam);
    if (is_gamma)
        STORE(gamma_basis, at, new.weight);
    else
        STORE(sigma_basis, at, new.weight);
    STORE(first, moment, new.first);
    STORE(second, moment, new.second);
}

void main() {
    const uint lane = gl_LocalInvocationID.x, column = lane % kMaxBases;
    if (column >= push.bases) return;
    float gradient = 0.0;
    for (uint group = 0u; group < count.groups_x; ++group) gradient += partials[group * (2u * kMaxBases) + lane];
    const TimeRows time = rows_of_time(push.frame, push.frames);
    const vec2 shares = row_element_adjoint(time);
    move_element(lane >= kMaxBases, time.first, column, shares.x * gradient);
    if (shares.y > 0.0) move_element(lane >= kMaxBases, time.second, column, shares.y * gradient);
}
