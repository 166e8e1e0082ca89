// Inspecting rays: what a walk was like in place of the light that it gathered, and the pass that makes images
// of it.
//
// An instance that is traced into kOutputInspect (shared/trace.h) leaves in the rays' buffers
//   radiance: the octree's level (a leaf's edge is the box's / 2^level) of the leaf in which the alpha of one instance,
//   the
//             nearest to do so, first passes kInspectAlpha, 0 where none does; steps of all instances' walks: nodes
//             that they came to and leaves that they sampled; 0; alpha of all
//   depth:    how far away that leaf was met, world metres; infinity where level is 0
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
    uint samples;       // rays a pixel, along each side; 1, too, where rays are fewer than pixels
    uint tiles_across;  // of a view's rays
    uint tiles_down;
    uint level;   // 1: levels, 0: steps
    float least;  // the map's first colour, and its last
    float most;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::InspectPush) == 36);
#endif
#endif
