// The volume depth pass: the distance of performers along the camera's axis, by which blended pieces of the set go
// before or behind them.
#ifndef NEUVV_SHARED_VOLUME_DEPTH_H
#define NEUVV_SHARED_VOLUME_DEPTH_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kVolumeRadiance = 0u;
CONSTEXPR uint kVolumeDepth = 1u;
CONSTEXPR uint kVolumeCameras = 2u;  // as kTraceCameras
CONSTEXPR uint kVolumeOut = 3u;      // r32f, per texel of the set's image

struct VolumeDepthPush {
    uint width;  // texels of a view
    uint height;
    uint views;
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
};

NEUVV_SHARED_END
#endif
