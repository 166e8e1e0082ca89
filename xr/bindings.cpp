#include "xr/bindings.h"

#include <algorithm>

#include "xr/openxr.h"

namespace neuvv {

namespace {

using enum HandAction;

const std::vector<ControllerProfile> kProfiles = {
    {"/interaction_profiles/khr/simple_controller",
     "Simple controller",
     nullptr,
     false,
     false,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/select/click"},
      {kSelect, "/user/hand/right/input/select/click"},
      {kMenu, "/user/hand/left/input/menu/click"},
      {kMenu, "/user/hand/right/input/menu/click"},
      {kHaptic, "/user/hand/left/output/haptic"},
      {kHaptic, "/user/hand/right/output/haptic"}}},
    {"/interaction_profiles/oculus/touch_controller",
     "Meta Touch",
     nullptr,
     true,
     false,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/trigger/value"},
      {kSelect, "/user/hand/right/input/trigger/value"},
      {kGrab, "/user/hand/left/input/squeeze/value"},
      {kGrab, "/user/hand/right/input/squeeze/value"},
      {kStick, "/user/hand/left/input/thumbstick"},
      {kStick, "/user/hand/right/input/thumbstick"},
      {kStickClick, "/user/hand/left/input/thumbstick/click"},
      {kStickClick, "/user/hand/right/input/thumbstick/click"},
      {kMenu, "/user/hand/left/input/y/click"},
      {kMenu, "/user/hand/left/input/menu/click"},
      {kUndo, "/user/hand/left/input/x/click"},
      {kPlay, "/user/hand/right/input/a/click"},
      {kDuplicate, "/user/hand/right/input/b/click"},
      {kHaptic, "/user/hand/left/output/haptic"},
      {kHaptic, "/user/hand/right/output/haptic"}}},
    {"/interaction_profiles/valve/index_controller",
     "Valve Index",
     nullptr,
     true,
     false,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/trigger/value"},
      {kSelect, "/user/hand/right/input/trigger/value"},
      {kGrab, "/user/hand/left/input/squeeze/value"},
      {kGrab, "/user/hand/right/input/squeeze/value"},
      {kStick, "/user/hand/left/input/thumbstick"},
      {kStick, "/user/hand/right/input/thumbstick"},
      {kStickClick, "/user/hand/left/input/thumbstick/click"},
      {kStickClick, "/user/hand/right/input/thumbstick/click"},
      {kMenu, "/user/hand/left/input/b/click"},
      {kUndo, "/user/hand/left/input/a/click"},
      {kPlay, "/user/hand/right/input/a/click"},
      {kDuplicate, "/user/hand/right/input/b/click"},
      {kHaptic, "/user/hand/left/output/haptic"},
      {kHaptic, "/user/hand/right/output/haptic"}}},
    {"/interaction_profiles/htc/vive_controller",
     "HTC Vive",
     nullptr,
     true,
     true,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/trigger/value"},
      {kSelect, "/user/hand/right/input/trigger/value"},
      {kGrab, "/user/hand/left/input/squeeze/click"},
      {kGrab, "/user/hand/right/input/squeeze/click"},
      {kStick, "/user/hand/left/input/trackpad"},
      {kStick, "/user/hand/right/input/trackpad"},
      {kStickClick, "/user/hand/left/input/trackpad/click"},
      {kStickClick, "/user/hand/right/input/trackpad/click"},
      {kMenu, "/user/hand/left/input/menu/click"},
      {kPlay, "/user/hand/right/input/menu/click"},
      {kHaptic, "/user/hand/left/output/haptic"},
      {kHaptic, "/user/hand/right/output/haptic"}}},
    {"/interaction_profiles/microsoft/motion_controller",
     "Windows Mixed Reality",
     nullptr,
     true,
     false,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/trigger/value"},
      {kSelect, "/user/hand/right/input/trigger/value"},
      {kGrab, "/user/hand/left/input/squeeze/click"},
      {kGrab, "/user/hand/right/input/squeeze/click"},
      {kStick, "/user/hand/left/input/thumbstick"},
      {kStick, "/user/hand/right/input/thumbstick"},
      {kStickClick, "/user/hand/left/input/thumbstick/click"},
      {kStickClick, "/user/hand/right/input/thumbstick/click"},
      {kMenu, "/user/hand/left/input/menu/click"},
      {kPlay, "/user/hand/right/input/menu/click"},
      {kUndo, "/user/hand/left/input/trackpad/click"},
      {kDuplicate, "/user/hand/right/input/trackpad/click"},
      {kHaptic, "/user/hand/left/output/haptic"},
      {kHaptic, "/user/hand/right/output/haptic"}}},
    {"/interaction_profiles/microsoft/hand_interaction",
     "Bare hands",
     XR_MSFT_HAND_INTERACTION_EXTENSION_NAME,
     true,
     false,
     {{kAim, "/user/hand/left/input/aim/pose"},
      {kAim, "/user/hand/right/input/aim/pose"},
      {kGrip, "/user/hand/left/input/grip/pose"},
      {kGrip, "/user/hand/right/input/grip/pose"},
      {kSelect, "/user/hand/left/input/select/value"},
      {kSelect, "/user/hand/right/input/select/value"},
      {kGrab, "/user/hand/left/input/squeeze/value"},
      {kGrab, "/user/hand/right/input/squeeze/value"}}},
};

}  // namespace

ActionName name_of(HandAction action) {
    switch (action) {
        case kAim:
            return {"aim", "Point", ActionKind::kPose};
        case kGrip:
            return {"grip", "Hold", ActionKind::kPose};
        case kSelect:
            return {"select", "Select, paint, press", ActionKind::kValue};
        case kGrab:
            return {"grab", "Grab and move", ActionKind::kValue};
        case kStick:
            return {"stick", "Walk, turn, speed", ActionKind::kAxes};
        case kStickClick:
            return {"stick_click", "Press the stick", ActionKind::kButton};
        case kMenu:
            return {"menu", "Show the panel", ActionKind::kButton};
        case kPlay:
            return {"play", "Play or pause", ActionKind::kButton};
        case kUndo:
            return {"undo", "Undo", ActionKind::kButton};
        case kDuplicate:
            return {"duplicate", "Duplicate", ActionKind::kButton};
        case kHaptic:
            return {"haptic", "Feel", ActionKind::kOutput};
    }
    return {};
}

const std::vector<ControllerProfile>& controller_profiles() {
    return kProfiles;
}

const ControllerProfile* find_profile(std::string_view path) {
    const auto found = std::find_if(kProfiles.begin(), kProfiles.end(), [&](const auto& p) { return path == p.path; });
    return found == kProfiles.end() ? nullptr : &*found;
}

}  // namespace neuvv
