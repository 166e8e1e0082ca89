// What the hands do at a time: what interaction sees of OpenXR.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "xr/pose.h"

namespace neuvv::xr {

constexpr int kLeft = 0, kRight = 1, kHands = 2;

struct HandInput {
    std::optional<Pose> aim, grip;  // tracking space; nothing while the hand is not tracked
    double select = 0, grab = 0;    // 0..1
    glm::dvec2 stick{0};            // x to the right, y away; 0 while a touch pad is not pressed
    // Since the last sample.
    bool menu = false, play = false, undo = false, duplicate = false;
    bool lacks_menu = false;  // a long press of the left hand on nothing shows the panel
    bool bare = false;        // the hand itself is seen: it holds no controller
    bool has_grab = true;     // else what is selected for long is grabbed
};

using HandInputs = std::array<HandInput, kHands>;

}  // namespace neuvv::xr
