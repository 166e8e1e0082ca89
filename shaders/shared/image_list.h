// The image list pass: from the tiles of rays that an instance may cover to the tiles of the images that use these
// rays, or that did so in the last frame.
#ifndef NEUVV_SHARED_IMAGE_LIST_H
#define NEUVV_SHARED_IMAGE_LIST_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kListCovered = 0u;  // per tile of rays: whether any instance of the frame may be seen there
CONSTEXPR uint kListCameras = 1u;  // as kTraceCameras; the first `views` of them define the positions of rays
CONSTEXPR uint kListImages = 2u;   // the listed tiles of images, then kNoTile
CONSTEXPR uint kListCount = 3u;    // a LiveCount of the listed tiles
CONSTEXPR uint kListShown = 4u;    // per tile of images: whether it used such rays in the last frame

struct ImageListPush {
    uint views;
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
    uint images_across;  // tiles of an image
    uint images_down;
    uint samples;  // samples per pixel along each side; the camera's pixels are samples
    uint radius;   // the number of rays beyond a pixel's edges that the pixel uses
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ImageListPush) == 28);
#endif
#endif
