// The temporal bases A and B: how many there may be, and which of their rows a time reads (errata 9). They are tables
// with a row for each frame and a column for each basis. A leaf's σ and hyper angle at a time are made of its weights
// times the row of that time.
#ifndef NEUVV_SHARED_TEMPORAL_BASIS_H
#define NEUVV_SHARED_TEMPORAL_BASIS_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMaxBases = 64u;  // C: temporal bases of density and of hyper angle
CONSTEXPR uint kMaxBasisPlanes = kMaxBases / 4u;

// The rows between which a time lies, and how near it is to the second: from 0, at the first, to below 1. Before the
// first and behind the last frame they are theirs.
#ifdef __cplusplus
template <typename Real>
struct TimeRows {
    uint first, second;
    Real part;
};
template <typename Real>
constexpr TimeRows<Real> rows_of_time(Real frame, uint frames) {
#else
#define Real float
struct TimeRows {
    uint first, second;
    float part;
};
TimeRows rows_of_time(float frame, uint frames) {
#endif
    const Real last = Real(frames - 1u);
    const Real at = frame > Real(0) ? (frame < last ? frame : last) : Real(0);
    const uint first = uint(at), second = first + 1u < frames ? first + 1u : first;
#ifdef __cplusplus
    return {first, second, at - Real(first)};
#else
    return TimeRows(first, second, at - Real(first));
#undef Real
#endif
}

NEUVV_SHARED_END
#endif
