// Shadow blur: performers seen from a light → their soft shadow map (shadow.glsl).
#ifndef NEUVV_SHARED_SHADOW_BLUR_H
#define NEUVV_SHARED_SHADOW_BLUR_H
#include "shared/lights.h"

NEUVV_SHARED

CONSTEXPR uint kBlurReach = 5u;     // texels that the filter takes on each side
CONSTEXPR float kBlurSigma = 1.6f;  // texels

CONSTEXPR uint kBlurRadiance = 0u;  // rays, one a texel, in tile order
CONSTEXPR uint kBlurDepth = 1u;
CONSTEXPR uint kBlurFrom = 2u;  // the first pass's result, in rows, which the second reads
CONSTEXPR uint kBlurTo = 3u;    // rg32f, rows of kPerformerShadowSide² texels a map

struct ShadowBlurPush {
    uint view;       // of the rays
    uint first_out;  // texel of the map that is written
};

NEUVV_SHARED_END
#endif
