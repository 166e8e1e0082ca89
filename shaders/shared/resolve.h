// The resolve pass: from rays in tile order to an 8-bit sRGB image in rows. A pixel is the mean of samples × samples
// rays. The upscale pass does the same where there are fewer rays than pixels.
#ifndef NEUVV_SHARED_RESOLVE_H
#define NEUVV_SHARED_RESOLVE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kResolveRadiance = 0u;
CONSTEXPR uint kResolveDepth = 1u;
CONSTEXPR uint kResolveImage = 2u;  // one R8G8B8A8 word per pixel

CONSTEXPR uint kResolveTiles = 3u;  // where only some tiles are resolved: these, then kNoTile

CONSTEXPR uint kResolveCameras = 4u;  // as kTraceCameras
// The set's images (render/set/set_raster.h): a texel per ray, or per pixel where there are fewer rays than pixels
CONSTEXPR uint kResolveSetColour = 5u;
CONSTEXPR uint kResolveSetFront = 6u;
CONSTEXPR uint kResolveSetDepth = 7u;
CONSTEXPR uint kUpscaleRadius = 2u;  // rays that the filter of upscale.comp uses on each side of a position

// What the image shows.
CONSTEXPR uint kShowColour = 0u;
CONSTEXPR uint kShowAlpha = 1u;
CONSTEXPR uint kShowDepth = 2u;  // from white (near) to black (far)
CONSTEXPR uint kShowLevel = 3u;  // of leaves, by inspect.comp
CONSTEXPR uint kShowCost = 4u;   // steps of walks, by inspect.comp

struct ResolvePush {
    vec4 background;  // linear RGB; w: its opacity, 0 for a transparent image
    uint width;
    uint height;
    uint show;
    float depth_near;  // metres
    float depth_far;
    uint samples;       // rays per pixel along each side; 1 in upscale.comp
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
    uint views;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ResolvePush) == 52);
#endif
#endif
