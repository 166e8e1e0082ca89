// The room around the dome of cameras, for captures with a background: its walls, floor and ceiling are checkered.
#pragma once

#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::training {

struct Backdrop {
    glm::dvec3 low{0}, high{1};  // the room's corners in the world, metres; every camera stands inside
    double tile_m = 0.5;
};

// Where a ray from inside the room meets it.
struct Wall {
    int axis = 0;  // of the wall's normal
    bool is_floor = false;
    glm::dvec3 point{0};  // world, metres
};
Wall wall_along(const Backdrop& room, const glm::dvec3& eye, const glm::dvec3& direction);

// The direction in the world, not of unit length, in which a camera sees a place of its image (pixels).
glm::dvec3 direction_of(const stage::Camera& camera, double x, double y);

// What a camera sees of the room alone: an opaque image, each pixel of which is a mean over the pixel's area.
media::Image clean_plate(const Backdrop& backdrop, const stage::Camera& camera);

}  // namespace neuvv::training
