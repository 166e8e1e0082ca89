// The room around the dome for captures with a background: checkered walls and floor, fixed in the world.
#pragma once

#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::training {

struct Backdrop {
    glm::dvec3 low{0}, high{1};  // the room; every camera stands inside
    double tile_m = 0.5;
};

// What a camera sees of it: an opaque image, averaged over each pixel's area.
media::Image clean_plate(const Backdrop& backdrop, const stage::Camera& camera);

}  // namespace neuvv::training
