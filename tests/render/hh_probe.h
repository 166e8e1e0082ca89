// hh_probe.comp: the shaders' HH and SH functions at points that a test passes.
#ifndef NEUVV_TESTS_HH_PROBE_H
#define NEUVV_TESTS_HH_PROBE_H
#include "shared/hh_counts.h"

NEUVV_SHARED

CONSTEXPR uint kHhProbePoints = 0u;  // vec4(unit direction, γ) a point
CONSTEXPR uint kHhProbeOut = 1u;     // HhProbe a point

// Rows of R and dR/dγ as hh.glsl has them (row l, column n), then Y at its SH index.
struct HhProbe {
    vec4 radial[4];
    vec4 slope[4];
    vec4 sh[4];
};

NEUVV_SHARED_END
#endif
