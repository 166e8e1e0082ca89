// An eye that is parallel to none of the axes, and its camera.
#pragma once

#include "tools/viewer/tools/navigation.h"

namespace neuvv::test {

inline viewer::Eye some_eye() {
    viewer::Eye eye;
    eye.pivot = {0.2, 1, -0.3};
    eye.yaw = 0.7;
    eye.pitch = -0.4;
    eye.distance = 4;
    eye.angle_y = 0.8;
    return eye;
}

inline stage::Camera some_camera() {
    return viewer::camera_of(some_eye(), 640, 480);
}

}  // namespace neuvv::test
