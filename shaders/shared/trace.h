// The trace pass: rays of 8×8 pixel tiles through a slice.
#ifndef NEUVV_SHARED_TRACE_H
#define NEUVV_SHARED_TRACE_H
#include "shared/field.h"

NEUVV_SHARED

CONSTEXPR uint kTile = 8u;  // pixels a side
CONSTEXPR uint kTilePixels = 64u;
CONSTEXPR uint kNoTile = 0xffffffffu;  // ends a list of tiles

CONSTEXPR uint kTraceNodes = 0u;
CONSTEXPR uint kTraceChildren = 1u;
CONSTEXPR uint kTraceHead = 2u;
CONSTEXPR uint kTraceTop = 14u;
CONSTEXPR uint kTraceNodeLive = 15u;
CONSTEXPR uint kTraceSh = 3u;
CONSTEXPR uint kTraceCameras = 4u;
CONSTEXPR uint kTraceTiles = 5u;
CONSTEXPR uint kTraceRadiance = 6u;  // per ray: premultiplied linear RGB, alpha
CONSTEXPR uint kTraceDepth = 7u;     // per ray: metres along the ray, infinity where alpha is 0
// direct.comp reads weights and rows in place of head and SH
CONSTEXPR uint kTraceWeights = 8u;
CONSTEXPR uint kTraceRows = 9u;

// trace_tree.comp reads a slice tree
CONSTEXPR uint kTraceEntries = 10u;
// of instances: the tiles where an instance may be seen
CONSTEXPR uint kTraceTileList = 11u;
CONSTEXPR uint kTraceTileRanges = 12u;
CONSTEXPR uint kTracePages = 16u;  // shared/segments.h
CONSTEXPR uint kTraceHeads = 17u;
CONSTEXPR uint kTraceSetDepth = 18u;  // metres along the camera's axis, a texel of the set's image each
CONSTEXPR uint kTraceLights = 19u;    // ShaderLights (shared/lights.h)
CONSTEXPR uint kTraceSetShadows = 20u;
CONSTEXPR uint kTracePerformerShadows = 21u;
CONSTEXPR uint kTraceSharing = 22u;  // as kRangeSharing

// Whether the stage's lights shine on an instance, and whether shadows fall on it
CONSTEXPR uint kLit = 1u;
CONSTEXPR uint kShadowed = 2u;

// What becomes of a ray's result (store_instance.glsl)
CONSTEXPR uint kOutputRay = 0u;           // it alone
CONSTEXPR uint kOutputLayer = 1u;         // under what stands there
CONSTEXPR uint kOutputLayerByDepth = 2u;  // over or under it, by depth (errata 11)
CONSTEXPR uint kOutputSegments = 3u;
CONSTEXPR uint kOutputInspect = 4u;  // no light, but what the walk was like (shared/inspect.h)

// Where the rays of an axis stand in the image: as dense as the slopes say before, inside and beyond an inset
// (grid.glsl).
struct GridAxis {
    vec4 knots;   // the rays and the pixels at which the inset begins and ends: ray, ray, pixel, pixel
    vec4 slopes;  // pixels a ray before, inside and beyond it
};

// Place (x, y) of the image, in pixels, is seen along normalize(corner + x·right + y·down), world space.
struct ShaderCamera {
    vec4 origin;
    vec4 right;   // w: rays across
    vec4 down;    // w: rays down
    vec4 corner;  // w: rays of an image's pixel along each side, which are pixels here
    GridAxis across;
    GridAxis downwards;
};
CONSTEXPR uint kCameraTexels = 8u;

// One workgroup's pixels: rays tile*64 .. +63 in row-major order inside the tile. One texel.
struct Tile {
    uint camera;
    uint x;  // of the top left pixel
    uint y;
    uint jitter;  // packSnorm2x16 of a shift in pixels: its rays leave from there, not from the pixels' centres
};

struct TracePush {
    vec4 box_min;   // metres; w: rays stop where transmittance falls below this (0: never)
    vec4 box_size;  // metres; w: the instance's opacity
    TopBox top;
    uint leaf_count;  // direct.comp
    uint node_base;   // trace_tree.comp
    uint entry_base;
    uint shaded_stride;  // shaded entries of a view
    uint first_camera;   // of the instance's, one a view; before them stand the world's
    uint first_tile;     // of those that are traced, and their end
    uint end_tile;
    uint set_width;     // texels of the set's image, in rows; 0: there is no set
    uint set_texels;    // of a view
    uint lighting;      // of kLit, kShadowed
    uint levels_above;  // Field::levels_above
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ShaderCamera) == 16 * neuvv::kCameraTexels);
static_assert(sizeof(neuvv::Tile) == 16);
static_assert(sizeof(neuvv::TracePush) == 84);
#endif
#endif
