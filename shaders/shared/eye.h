// The passes that draw a headset's images: the images of both eyes with their depth, and over them shapes (controllers,
// rays, boxes) and text.
#ifndef NEUVV_SHARED_EYE_H
#define NEUVV_SHARED_EYE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kEyeImage = 0u;     // the output of resolve.comp, the left eye first
CONSTEXPR uint kEyeRadiance = 1u;  // the rays from which that image was resolved
CONSTEXPR uint kEyeDepth = 2u;
CONSTEXPR uint kEyeCameras = 3u;
CONSTEXPR uint kEyeSetDepth = 4u;

struct EyePush {
    uint width;  // pixels of an eye
    uint height;
    uint tiles_across;  // tiles of an eye's rays
    uint tiles_down;
    float near_m;    // distance along the axis, metres, that has depth 1; depth 0 is infinitely far
    float vignette;  // 0 none, 1 strongest
};

CONSTEXPR uint kShapePosition = 0u;  // vec3, world, metres
CONSTEXPR uint kShapeColour = 1u;    // vec4, linear, premultiplied

CONSTEXPR uint kTextPosition = 0u;  // vec3, world, metres
CONSTEXPR uint kTextColour = 1u;    // vec4, linear, premultiplied
CONSTEXPR uint kTextUv = 2u;        // vec2, in the font's image
CONSTEXPR uint kTextFont = 0u;      // the font's image: how much of a pixel is covered, in red

struct ShapePush {            // of shapes and of text
    mat4 clip_from_world[2];  // of the left and the right eye
};

NEUVV_SHARED_END
#endif
