// The reads by which a device's profiles of long arrays are timed (engine/gpu/buffer_speed.h).
#ifndef NEUVV_SHARED_BUFFER_SPEED_H
#define NEUVV_SHARED_BUFFER_SPEED_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kSpeedGroup = 64u;
CONSTEXPR uint kSpeedReads = 16u;           // of each array, by each thread
CONSTEXPR uint kSpeedElements = 1u << 20u;  // of each array, of 8 bytes each

CONSTEXPR uint kSpeedWeights = 0u;
CONSTEXPR uint kSpeedEntries = 1u;
CONSTEXPR uint kSpeedOut = 2u;

NEUVV_SHARED_END
#endif
