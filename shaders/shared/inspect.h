// Inspection of rays: statistics of a ray's walk in place of the light that it gathers, and the pass that turns them
// into images.
//
// Where an instance is traced with kOutputInspect (shared/trace.h), a ray's `radiance` and `depth` have another
// meaning.
//   radiance.x  the octree level (a leaf's edge is the box's / 2^level) of the leaf in which the alpha of an instance
//               first exceeds kInspectAlpha, for the nearest instance where it does; 0 where it does for none
//   radiance.y  steps of the walks of all instances: the nodes that they entered and the leaves that they sampled
//   radiance.z  0
//   radiance.w  alpha of all instances together
//   depth       the distance at which that leaf's instance exceeds kInspectAlpha, world metres; infinity where x is 0
#ifndef NEUVV_SHARED_INSPECT_H
#define NEUVV_SHARED_INSPECT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR float kInspectAlpha = 0.5f;

CONSTEXPR uint kInspectRays = 0u;
CONSTEXPR uint kInspectDepth = 1u;
CONSTEXPR uint kInspectCameras = 2u;  // as kTraceCameras
CONSTEXPR uint kInspectImage = 3u;    // as kResolveImage

struct InspectPush {
    uint width;
    uint height;
    uint views;
    uint samples;       // rays per pixel along each side; also 1 where there are fewer rays than pixels
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
    uint level;            // 1: the image shows levels, 0: steps
    float colour_map_min;  // the value with the first colour of the map
    float colour_map_max;  // the value with its last colour
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::InspectPush) == 36);
#endif
#endif
