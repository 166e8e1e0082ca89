// The colour map viridis (S. van der Walt, N. Smith; CC0) as polynomials of degree 6, which differ from matplotlib's
// table by at most 3/255. A value v of 0..1 has the sRGB colour Σ kViridisN v^N.
#ifndef NEUVV_SHARED_COLOUR_MAP_H
#define NEUVV_SHARED_COLOUR_MAP_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR vec4 kViridis0 = vec4(0.2769, 0.0038, 0.3377, 0.0);
CONSTEXPR vec4 kViridis1 = vec4(-0.1374, 1.4892, 0.9541, 0.0);
CONSTEXPR vec4 kViridis2 = vec4(2.0837, -0.7281, 5.1219, 0.0);
CONSTEXPR vec4 kViridis3 = vec4(-13.1681, -2.0212, -40.5236, 0.0);
CONSTEXPR vec4 kViridis4 = vec4(20.1448, 7.3047, 97.2847, 0.0);
CONSTEXPR vec4 kViridis5 = vec4(-5.8875, -7.9009, -101.2765, 0.0);
CONSTEXPR vec4 kViridis6 = vec4(-2.3292, 2.7574, 38.2373, 0.0);

NEUVV_SHARED_END
#endif
