// How the rows of A and B make the row of a time between frames, and the adjoint: where its gradient goes (errata 9).
#ifndef NEUVV_TEMPORAL_BASIS_GLSL
#define NEUVV_TEMPORAL_BASIS_GLSL
#include "shared/temporal_basis.h"

// An element of the row of a time, from those of the rows that it reads.
float row_element(TimeRows time, float first, float second) { return mix(first, second, time.part); }

// The shares of the element's gradient that go to those of the first and the second row. The second gets none where it
// is not read.
vec2 row_element_adjoint(TimeRows time) { return vec2(1.0 - time.part, time.part); }

// The same by row: the share that a row of the table has in that of a time.
float share_of_row(uint row, float frame, uint frames) {
    return max(1.0 - abs(float(row) - clamp(frame, 0.0, float(frames - 1u))), 0.0);
}

#endif
