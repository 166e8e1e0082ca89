// The picture list pass: tiles of rays that see anything → tiles of the pictures that take from them.
#ifndef NEUVV_SHARED_PICTURE_LIST_H
#define NEUVV_SHARED_PICTURE_LIST_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kListSeen = 0u;      // per tile of rays: whether any instance of the frame may be seen there
CONSTEXPR uint kListCameras = 1u;   // as kTraceCameras: where rays stand is as the first `views` of them say
CONSTEXPR uint kListPictures = 2u;  // those tiles, then kNoTile
CONSTEXPR uint kListCount = 3u;     // a LiveCount of them

struct PictureListPush {
    uint views;
    uint tiles_across;  // of a view's rays
    uint tiles_down;
    uint pictures_across;  // tiles of a picture
    uint pictures_down;
    uint samples;  // rays a pixel along each side, which are the camera's pixels
    uint reach;    // rays that a pixel takes beyond those at its edges
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::PictureListPush) == 28);
#endif
#endif
