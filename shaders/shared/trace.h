// The trace passes: the rays of tiles of 8×8 pixels through a slice or a field.
#ifndef NEUVV_SHARED_TRACE_H
#define NEUVV_SHARED_TRACE_H
#include "shared/field.h"

NEUVV_SHARED

CONSTEXPR uint kTile = 8u;  // pixels of a tile's side
CONSTEXPR uint kTilePixels = 64u;
CONSTEXPR uint kNoTile = 0xffffffffu;  // the end of a list of tiles

CONSTEXPR uint kTraceNodes = 0u;
CONSTEXPR uint kTraceHead = 2u;
CONSTEXPR uint kTraceLinks = 1u;  // as Field::links
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
// Only where instances are traced: the tiles that the instance may cover
CONSTEXPR uint kTraceTileList = 11u;
CONSTEXPR uint kTraceTileRanges = 12u;
CONSTEXPR uint kTracePages = 16u;     // shared/intervals.h
CONSTEXPR uint kTraceSetDepth = 18u;  // per texel of the set's image: metres along the camera's axis
CONSTEXPR uint kTraceLights = 19u;    // ShaderLights (shared/lights.h)
CONSTEXPR uint kTraceSetShadows = 20u;
CONSTEXPR uint kTracePerformerShadows = 21u;
CONSTEXPR uint kTraceSharing = 22u;  // as kRangeSharing

// Whether the stage's lights shine on an instance, and whether shadows fall on it
CONSTEXPR uint kLit = 1u;
CONSTEXPR uint kShadowed = 2u;

// How a ray's result is stored (store_instance.glsl)
CONSTEXPR uint kOutputRay = 0u;           // it replaces what is stored
CONSTEXPR uint kOutputLayer = 1u;         // it is blended under what is stored
CONSTEXPR uint kOutputLayerByDepth = 2u;  // it is blended over or under what is stored, by depth (errata 11)
CONSTEXPR uint kOutputIntervals = 3u;     // its intervals are stored for merge.comp
CONSTEXPR uint kOutputInspect = 4u;       // statistics of the walk are stored instead of light (shared/inspect.h)

// What a sample costs, by which march.glsl says how a walk loops
CONSTEXPR uint kSampleLikeStep = 0u;      // no more than a step over an empty cell
CONSTEXPR uint kSampleBelowDescent = 1u;  // more than that, but less than a descent to the next node
CONSTEXPR uint kSampleAboveDescent = 2u;

// The positions of rays along one axis of the image; their density differs before, inside and beyond an inset
// (grid.glsl).
struct GridAxis {
    vec4 knots;   // the rays and the pixels at which the inset begins and ends: ray, ray, pixel, pixel
    vec4 slopes;  // pixels per ray before, inside and beyond the inset
};

// The ray through the position (x, y) of the image, in pixels, has the direction normalize(corner + x·right + y·down).
struct ShaderCamera {
    vec4 origin;  // metres
    vec4 right;   // w: rays across
    vec4 down;    // w: rays down
    vec4 corner;  // w: rays per pixel of the final image along each side; "pixels" of this camera are these samples
    GridAxis across;
    GridAxis downwards;
};
CONSTEXPR uint kCameraTexels = 8u;

// One workgroup's pixels: rays tile*64 .. +63 in row-major order inside the tile. One texel.
struct Tile {
    uint camera;
    uint x;  // of the top left pixel
    uint y;
    uint jitter;  // packSnorm2x16 of a shift in pixels from the pixels' centres to the positions of the rays
};

struct TracePush {
    vec4 box_min;   // metres; w: the transmittance below which a ray ends (0: never)
    vec4 box_size;  // metres; w: the instance's opacity
    TopBox top;
    uint leaf_count;  // direct.comp
    uint node_base;   // trace_tree.comp
    uint entry_base;
    uint shaded_stride;  // shaded entries of a view
    uint first_camera;   // the instance's camera of the first view; the world's cameras come before all instances'
    uint first_tile;     // the tiles from first_tile to before end_tile are traced
    uint end_tile;
    uint set_width;     // texels of a row of the set's image; 0: there is no set
    uint set_texels;    // texels of a view of the set's image
    uint lighting;      // kLit, kShadowed, both or 0
    uint levels_above;  // Field::levels_above
    float density;      // what the instance's densities are multiplied by
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ShaderCamera) == 16 * neuvv::kCameraTexels);
static_assert(sizeof(neuvv::Tile) == 16);
static_assert(sizeof(neuvv::TracePush) == 88);
#endif
#endif
