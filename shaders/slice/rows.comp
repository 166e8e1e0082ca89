// Rows: interpolates the rows A_t and B_t of a fractional frame (errata 9), adds the addresses of the weights, and
// clears the live count for the slice that follows. Reads the bases (frames × bases); writes BasisRows. One thread per
// column; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice.h"
#include "slice/temporal_basis.glsl"

layout(local_size_x = 64) in;
READ_ARRAY(float, kRowsSigmaBasis, sigma_basis);
READ_ARRAY(float, kRowsGammaBasis, gamma_basis);
layout(binding = kRowsOut, std430) writeonly buffer Rows { BasisRows rows; };
layout(binding = kRowsLive, std430) writeonly buffer Live { LiveCount live; };
layout(push_constant) uniform Push { RowsPush push; };

shared vec2 row[kMaxBases];  // elements of A_t and B_t

vec4 row_plane(uint p, uint basis) {
    return vec4(row[4u * p][basis], row[4u * p + 1u][basis], row[4u * p + 2u][basis], row[4u * p + 3u][basis]);
}

void write_rows() {
    uvec2 count = uvec2(0u), first = uvec2(0u);
    for (uint p = 0u; p < kMaxBasisPlanes; ++p) {
        const vec4 sigma = row_plane(p, 0u), gamma = row_plane(p, 1u);
        if (sigma != vec4(0.0)) {
            if (count.x == 0u) first.x = p;
            rows.sigma[count.x] = sigma;
            rows.planes[count.x++].x = p;
        }
        if (gamma != vec4(0.0)) {
            if (count.y == 0u) first.y = p;
            rows.gamma[count.y] = gamma;
            rows.planes[count.y++].y = p;
        }
    }
    for (uint i = count.x; i < kMaxBasisPlanes; ++i) {
        rows.sigma[i] = vec4(0.0);
        rows.planes[i].x = first.x;
    }
    for (uint i = count.y; i < kMaxBasisPlanes; ++i) {
        rows.gamma[i] = vec4(0.0);
        rows.planes[i].y = first.y;
    }
}

void main() {
    const uint column = gl_LocalInvocationID.x;
    const TimeRows time = rows_of_time(push.frame, push.frames);
    float sigma = 0.0, gamma = 0.0;
    if (column < push.bases) {
        const int a = int(time.first * push.bases + column), b = int(time.second * push.bases + column);
        sigma = row_element(time, FETCH(sigma_basis, a).x, FETCH(sigma_basis, b).x);
        gamma = row_element(time, FETCH(gamma_basis, a).x, FETCH(gamma_basis, b).x);
    }
    row[column] = vec2(sigma, gamma);
    barrier();
    if (column != 0u) return;
    write_rows();
    rows.weights = push.weights;
    rows.part_planes_log2 = push.part_planes_log2;
    live = LiveCount(0u, 1u, 1u, 0u, 0u);
}
