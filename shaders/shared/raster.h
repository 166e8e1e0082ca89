// The raster pass: triangles of a posed glTF scene → linear premultiplied colour.
#ifndef NEUVV_SHARED_RASTER_H
#define NEUVV_SHARED_RASTER_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kRasterPosition = 0u;  // vertex attributes
CONSTEXPR uint kRasterNormal = 1u;
CONSTEXPR uint kRasterUv = 2u;
CONSTEXPR uint kRasterColour = 3u;
CONSTEXPR uint kRasterTangent = 4u;  // only in the set's passes (shared/set.h), as the next
CONSTEXPR uint kRasterMapUvs = 5u;   // 5 and 6

CONSTEXPR uint kRasterTexture = 0u;

struct RasterPush {
    mat4 clip_from_world;
    vec4 base_colour;    // linear, straight alpha
    float alpha_cutoff;  // fragments of smaller alpha are dropped; < 0: none is
    float opaque;        // 1: alpha is set to 1 after the cutoff
    float sky;           // share of the light that comes from above; 0 for unlit materials
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::RasterPush) == 92);
#endif
#endif
