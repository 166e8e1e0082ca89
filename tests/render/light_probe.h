// The probe of lights and shadows in a compute shader (light_probe.comp).
#ifndef NEUVV_TEST_LIGHT_PROBE_H
#define NEUVV_TEST_LIGHT_PROBE_H
#include "shared/lights.h"

NEUVV_SHARED

CONSTEXPR uint kProbePositions = 0u;  // rgba32f: world; w unused
CONSTEXPR uint kProbeLights = 1u;
CONSTEXPR uint kProbeSetShadows = 2u;
CONSTEXPR uint kProbePerformerShadows = 3u;
CONSTEXPR uint kProbeOut =
    4u;  // per position and light: (light, set shadow), (direction to the light, performer shadow)

struct LightProbePush {
    uint positions;
};

NEUVV_SHARED_END
#endif
