// The rows A_t and B_t at a fractional frame (errata 9), read from the parameters of Ψ. The file that includes this one
// defines `parameters` as floats, and `push`.
#ifndef NEUVV_PSI_BASIS_ROWS_GLSL
#define NEUVV_PSI_BASIS_ROWS_GLSL

#include "slice/temporal_basis.glsl"

float row_share(uint row) { return share_of_row(row, push.frame, push.frames); }

// Element c of A_t (kind 0) or B_t (kind 1).
float row_at(uint kind, uint c) {
    const uint first = push.sigma_rows_offset + kind * push.frames * push.bases;
    const TimeRows time = rows_of_time(push.frame, push.frames);
    const float here = row_share(time.first) * parameters[first + time.first * push.bases + c];
    if (time.second == time.first) return here;
    return here + row_share(time.second) * parameters[first + time.second * push.bases + c];
}

#endif
