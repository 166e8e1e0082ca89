// The positional encoding of NeRF: x, then sin 2^k π x and cos 2^k π x for k < kFrequencies, then zeros up to whole
// texels.
#ifndef NEUVV_PSI_ENCODE_GLSL
#define NEUVV_PSI_ENCODE_GLSL

// The angle 2^k π x without whole turns: Vulkan specifies the precision of sin and cos only in [−π, π].
vec3 half_turns(vec3 x, uint k) {
    const vec3 turns = x * float(1u << k);
    return kPi * (turns - 2.0 * round(0.5 * turns));
}

// Writes the encoding of this thread's sample into shared memory.
void encode(vec3 x) {
    for (uint c = 0u; c < 3u; ++c) set_act_of_sample(c, x[c]);
    for (uint k = 0u; k < kFrequencies; ++k) {
        const vec3 angle = half_turns(x, k), s = sin(angle), c = cos(angle);
        for (uint i = 0u; i < 3u; ++i) {
            set_act_of_sample(3u + 6u * k + i, s[i]);
            set_act_of_sample(6u + 6u * k + i, c[i]);
        }
    }
    for (uint row = 3u + 6u * kFrequencies; row < kInputs; ++row) set_act_of_sample(row, 0.0);
}

#endif
