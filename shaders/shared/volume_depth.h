// Volume depth: how far along the camera's axis performers are, for what is blended before or behind them.
#ifndef NEUVV_SHARED_VOLUME_DEPTH_H
#define NEUVV_SHARED_VOLUME_DEPTH_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kVolumeRadiance = 0u;
CONSTEXPR uint kVolumeDepth = 1u;
CONSTEXPR uint kVolumeCameras = 2u;  // as kTraceCameras
CONSTEXPR uint kVolumeOut = 3u;      // r32f, a texel of the set's image each

struct VolumeDepthPush {
    uint width;  // texels of a view
    uint height;
    uint views;
    uint tiles_across;  // of a view's rays
    uint tiles_down;
};

NEUVV_SHARED_END
#endif
