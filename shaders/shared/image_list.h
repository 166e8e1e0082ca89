// The image list pass: tiles of rays that see anything → tiles of the images that take from them.
#ifndef NEUVV_SHARED_IMAGE_LIST_H
#define NEUVV_SHARED_IMAGE_LIST_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kListCovered = 0u;  // per tile of rays: whether any instance of the frame may be seen there
CONSTEXPR uint kListCameras = 1u;  // as kTraceCameras: where rays stand is as the first `views` of them say
CONSTEXPR uint kListImages = 2u;   // those tiles, then kNoTile
CONSTEXPR uint kListCount = 3u;    // a LiveCount of them

struct ImageListPush {
    uint views;
    uint tiles_across;  // of a view's rays
    uint tiles_down;
    uint images_across;  // tiles of an image
    uint images_down;
    uint samples;  // rays a pixel along each side, which are the camera's pixels
    uint reach;    // rays that a pixel takes beyond those at its edges
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ImageListPush) == 28);
#endif
#endif
