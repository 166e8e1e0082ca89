// What goes to a headset: both eyes' images with their depth, and over them what hands hold and point with.
#ifndef NEUVV_SHARED_EYE_H
#define NEUVV_SHARED_EYE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kEyeImage = 0u;     // as resolve.comp leaves it, the left eye's first
CONSTEXPR uint kEyeRadiance = 1u;  // and the rays that it is of
CONSTEXPR uint kEyeDepth = 2u;
CONSTEXPR uint kEyeCameras = 3u;
CONSTEXPR uint kEyeSetDepth = 4u;

struct EyePush {
    uint width;  // pixels of an eye
    uint height;
    uint tiles_across;  // of an eye's rays
    uint tiles_down;
    float near_m;    // what is there has depth 1, infinity 0
    float vignette;  // 0 none, 1 strongest
};

CONSTEXPR uint kShapePlace = 0u;   // vec3, world
CONSTEXPR uint kShapeColour = 1u;  // vec4, linear, premultiplied

struct ShapePush {
    mat4 clip_from_world[2];  // by eye
};

NEUVV_SHARED_END
#endif
