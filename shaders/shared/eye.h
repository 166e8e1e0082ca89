// The passes that draw a headset's images: the images of all views with their depth, and over them shapes (controllers,
// rays, boxes) and text.
#ifndef NEUVV_SHARED_EYE_H
#define NEUVV_SHARED_EYE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kEyeImage = 0u;     // the output of resolve.comp, view by view
CONSTEXPR uint kEyeRadiance = 1u;  // the rays from which that image was resolved
CONSTEXPR uint kEyeDepth = 2u;
CONSTEXPR uint kEyeCameras = 3u;
CONSTEXPR uint kEyeSetDepth = 4u;

struct EyePush {
    uint width;  // pixels of a view
    uint height;
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
    float near_m;    // distance along the axis, metres, that has depth 1; depth 0 is infinitely far
    float vignette;  // 0 none, 1 strongest
    float fade;      // of the whole image: 0 none, 1 black
};

// The vignette is dark where rays are farther from the optical axis than this, as tangents of the angle: of the weakest
// and of the strongest one, where it begins and where all is black.
CONSTEXPR float kWeakFrom = 1.1f;
CONSTEXPR float kWeakBlack = 1.3f;
CONSTEXPR float kStrongFrom = 0.4f;
CONSTEXPR float kStrongBlack = 0.7f;

CONSTEXPR uint kShapePosition = 0u;  // vec3, world, metres
CONSTEXPR uint kShapeColour = 1u;    // vec4, linear, premultiplied

CONSTEXPR uint kTextPosition = 0u;  // vec3, world, metres
CONSTEXPR uint kTextColour = 1u;    // vec4, linear, premultiplied
CONSTEXPR uint kTextUv = 2u;        // vec2, in the font's image
CONSTEXPR uint kTextFont = 0u;      // the font's image: how much of a pixel is covered, in red

// Of shapes and of text. All devices have room for two matrices: four views are drawn by two draws.
struct ShapePush {
    mat4 clip_from_world[2];  // of the left and the right eye; the view's number is that of the instance
};

NEUVV_SHARED_END
#endif
