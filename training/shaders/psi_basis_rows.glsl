// The rows A_t and B_t at a fractional frame (errata 9), read from the parameters of Ψ. The file that includes this one
// defines `parameters` as floats, and `push`.
#ifndef NEUVV_PSI_BASIS_ROWS_GLSL
#define NEUVV_PSI_BASIS_ROWS_GLSL

uint frame_before() { return min(uint(clamp(push.frame, 0.0, float(push.frames - 1u))), push.frames - 1u); }

// The share that a row of A or B has at this frame.
float row_share(uint row) { return max(1.0 - abs(float(row) - clamp(push.frame, 0.0, float(push.frames - 1u))), 0.0); }

// Element c of A_t (kind 0) or B_t (kind 1).
float row_at(uint kind, uint c) {
    const uint first = push.sigma_rows_offset + kind * push.frames * push.bases, before = frame_before();
    const uint after = min(before + 1u, push.frames - 1u);
    const float here = row_share(before) * parameters[first + before * push.bases + c];
    return after == before ? here : here + row_share(after) * parameters[first + after * push.bases + c];
}

#endif
