// The input of both hands at one time: all that the interaction with a stage sees of OpenXR.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "xr/pose.h"

namespace neuvv::xr {

constexpr int kLeft = 0, kRight = 1, kHands = 2;

struct HandInput {
    std::optional<Pose> aim, grip;  // tracking space; empty while the hand is not tracked
    double select = 0, grab = 0;    // 0..1
    glm::dvec2 stick{0};            // x to the right, y away from the user; 0 while a touch pad is not pressed
    // Whether these buttons were pressed since the last sample.
    bool menu = false, play = false, undo = false, duplicate = false;
    bool lacks_menu = false;  // without a menu button, a long press of the left hand on nothing shows the panel
    bool bare_hand = false;   // the hand itself is tracked and holds no controller
    bool has_grab = true;     // without a grab button, a long press of select grabs
};

using HandInputs = std::array<HandInput, kHands>;

}  // namespace neuvv::xr
