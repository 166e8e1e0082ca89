// Interpolates the rows A_t and B_t of a fractional frame (errata 9) and clears the live count for the slice that follows.
// Reads the bases (frames × bases); writes BasisRows padded with zeros. One thread per column; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice.h"

layout(local_size_x = 64) in;
layout(binding = kRowsSigmaBasis) uniform textureBuffer sigma_basis;
layout(binding = kRowsGammaBasis) uniform textureBuffer gamma_basis;
layout(binding = kRowsOut, std430) writeonly buffer Rows { float rows[]; };
layout(binding = kRowsLive, std430) writeonly buffer Live { LiveCount live; };
layout(push_constant) uniform Push { RowsPush push; };

void main() {
    const uint column = gl_LocalInvocationID.x;
    const float frame = clamp(push.frame, 0.0, float(push.frames - 1u));
    const uint before = min(uint(frame), push.frames - 1u), after = min(before + 1u, push.frames - 1u);
    const float part = frame - float(before);
    float sigma = 0.0, gamma = 0.0;
    if (column < push.bases) {
        const int a = int(before * push.bases + column), b = int(after * push.bases + column);
        sigma = mix(texelFetch(sigma_basis, a).x, texelFetch(sigma_basis, b).x, part);
        gamma = mix(texelFetch(gamma_basis, a).x, texelFetch(gamma_basis, b).x, part);
    }
    rows[column] = sigma;
    rows[kMaxBases + column] = gamma;
    if (column == 0u) live = LiveCount(0u, 1u, 1u, 0u, 0u);
}
