// The pass that draws the left eye's image, and the panel beneath it, for a window on the desktop.
#ifndef NEUVV_SHARED_MIRROR_H
#define NEUVV_SHARED_MIRROR_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMirrorEye = 0u;    // the eye's image: linear, premultiplied
CONSTEXPR uint kMirrorPanel = 1u;  // the panel's image: sRGB

struct MirrorPush {
    // The upper left 3×3 matrix takes (x, y, 1) in the eye's clip space to (u, v, 1) on the panel, 0..1 from its upper
    // left, up to a factor. The factor is positive where the panel is before the eye.
    mat4 panel_from_clip;
    uint has_panel;
};

NEUVV_SHARED_END
#endif
