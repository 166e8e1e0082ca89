// Sizes of the hyperspherical-harmonic (HH) basis and the order of its functions (errata 5).
//
// For n_max the basis has Σ_{n≤n_max} (n+1)² functions H_nlm, ordered by n, then l ≤ n, then m = −l..l:
//   index(n,l,m) = n(n+1)(2n+1)/6 + l² + l + m.
// The colour of a slice is given in real SH of degree n_max: (n_max+1)² functions, index l² + l + m.
#ifndef NEUVV_SHARED_HH_COUNTS_H
#define NEUVV_SHARED_HH_COUNTS_H
#include "shared/temporal_basis.h"
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMaxHhDegree = 3u;
CONSTEXPR uint kMaxHhCount = 30u;
CONSTEXPR uint kMaxShCount = 16u;

#ifdef __cplusplus
constexpr
#endif
    uint
    sh_count(uint degree) {
    return (degree + 1u) * (degree + 1u);
}
#ifdef __cplusplus
constexpr
#endif
    uint
    hh_count(uint degree) {
    return (degree + 1u) * (degree + 2u) * (2u * degree + 3u) / 6u;
}

NEUVV_SHARED_END
#endif
