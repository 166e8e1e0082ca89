// The resolve pass: rays in tile order → an 8-bit sRGB image in rows. A pixel is the mean of samples × samples rays.
// The upscale pass: the same where rays are fewer than pixels.
#ifndef NEUVV_SHARED_RESOLVE_H
#define NEUVV_SHARED_RESOLVE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kResolveRadiance = 0u;
CONSTEXPR uint kResolveDepth = 1u;
CONSTEXPR uint kResolveImage = 2u;  // one R8G8B8A8 word a pixel

CONSTEXPR uint kResolveTiles = 3u;  // where only some are resolved: those, then kNoTile

CONSTEXPR uint kResolveCameras = 4u;  // as kTraceCameras
// The set's images (render/set_raster.h): as many texels as rays a pixel, one a pixel where rays are fewer
CONSTEXPR uint kResolveSetColour = 5u;
CONSTEXPR uint kResolveSetFront = 6u;
CONSTEXPR uint kResolveSetDepth = 7u;
CONSTEXPR uint kUpscaleRadius = 2u;  // rays that its filter takes on each side of a place

CONSTEXPR uint kShowColour = 0u;
CONSTEXPR uint kShowAlpha = 1u;
CONSTEXPR uint kShowDepth = 2u;  // near white to far black
CONSTEXPR uint kShowLevel = 3u;  // these by inspect.comp
CONSTEXPR uint kShowCost = 4u;

struct ResolvePush {
    vec4 background;  // linear RGB; w: its opacity, 0 for a transparent image
    uint width;
    uint height;
    uint show;
    float depth_near;  // metres
    float depth_far;
    uint samples;       // rays a pixel, along each side; upscale.comp: fewer than one
    uint tiles_across;  // of a view's rays
    uint tiles_down;
    uint views;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ResolvePush) == 52);
#endif
#endif
