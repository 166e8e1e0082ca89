// The shadow blur pass: from the image of the performers as a light sees them to their soft shadow map (shadow.glsl).
#ifndef NEUVV_SHARED_SHADOW_BLUR_H
#define NEUVV_SHARED_SHADOW_BLUR_H
#include "shared/lights.h"

NEUVV_SHARED

CONSTEXPR uint kBlurRadius = 5u;    // texels that the filter uses on each side
CONSTEXPR float kBlurSigma = 1.6f;  // texels

CONSTEXPR uint kBlurRadiance = 0u;  // rays, one per texel, in tile order
CONSTEXPR uint kBlurDepth = 1u;
CONSTEXPR uint kBlurFrom = 2u;  // the first pass's result, in rows, which the second pass reads
CONSTEXPR uint kBlurTo = 3u;    // rg32f, in rows, kPerformerShadowSide² texels per map

struct ShadowBlurPush {
    uint view;       // the view of the rays
    uint first_out;  // the first texel that is written
};

NEUVV_SHARED_END
#endif
