#include "xr/bindings.h"

#include <algorithm>

#include "xr/openxr.h"

namespace neuvv::xr {

namespace {

using enum HandAction;
using enum BoundHands;

// Of Meta's controllers, and of those with the same buttons in the same places.
const std::vector<Binding> kAsMetaTouch = {
    {kAim, kBoth, "/input/aim/pose"},         {kGrip, kBoth, "/input/grip/pose"},
    {kSelect, kBoth, "/input/trigger/value"}, {kGrab, kBoth, "/input/squeeze/value"},
    {kStick, kBoth, "/input/thumbstick"},     {kMenu, kLeftHand, "/input/y/click"},
    {kMenu, kLeftHand, "/input/menu/click"},  {kUndo, kLeftHand, "/input/x/click"},
    {kPlay, kRightHand, "/input/a/click"},    {kDuplicate, kRightHand, "/input/b/click"},
    {kHaptic, kBoth, "/output/haptic"}};

const std::vector<ControllerProfile> kProfiles = {
    {"/interaction_profiles/khr/simple_controller",
     "Simple controller",
     nullptr,
     false,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/select/click"},
      {kMenu, kBoth, "/input/menu/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    // Where the runtime has no profile of what is held.
    {"/interaction_profiles/khr/generic_controller",
     "Generic controller",
     "XR_KHR_generic_controller",
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/value"},
      {kStick, kBoth, "/input/thumbstick"},
      {kMenu, kLeftHand, "/input/secondary/click"},
      {kUndo, kLeftHand, "/input/primary/click"},
      {kPlay, kRightHand, "/input/primary/click"},
      {kDuplicate, kRightHand, "/input/secondary/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/oculus/touch_controller", "Meta Touch", nullptr, true, false, kAsMetaTouch},
    {"/interaction_profiles/valve/index_controller",
     "Valve Index",
     nullptr,
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/value"},
      {kStick, kBoth, "/input/thumbstick"},
      {kMenu, kLeftHand, "/input/b/click"},
      {kUndo, kLeftHand, "/input/a/click"},
      {kPlay, kRightHand, "/input/a/click"},
      {kDuplicate, kRightHand, "/input/b/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/htc/vive_controller",
     "HTC Vive",
     nullptr,
     true,
     true,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/click"},
      {kStick, kBoth, "/input/trackpad"},
      {kPadClick, kBoth, "/input/trackpad/click"},
      {kMenu, kLeftHand, "/input/menu/click"},
      {kPlay, kRightHand, "/input/menu/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/microsoft/motion_controller",
     "Windows Mixed Reality",
     nullptr,
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/click"},
      {kStick, kBoth, "/input/thumbstick"},
      {kMenu, kLeftHand, "/input/menu/click"},
      {kPlay, kRightHand, "/input/menu/click"},
      {kUndo, kLeftHand, "/input/trackpad/click"},
      {kDuplicate, kRightHand, "/input/trackpad/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/facebook/touch_controller_pro", "Meta Quest Pro", "XR_FB_touch_controller_pro", true, false,
     kAsMetaTouch},
    {"/interaction_profiles/meta/touch_controller_plus", "Meta Touch Plus", "XR_META_touch_controller_plus", true,
     false, kAsMetaTouch},
    {"/interaction_profiles/bytedance/pico4_controller", "PICO 4", "XR_BD_controller_interaction", true, false,
     kAsMetaTouch},
    {"/interaction_profiles/htc/vive_focus3_controller",
     "HTC Vive Focus 3",
     "XR_HTC_vive_focus3_controller_interaction",
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/click"},
      {kStick, kBoth, "/input/thumbstick"},
      {kMenu, kLeftHand, "/input/y/click"},
      {kMenu, kLeftHand, "/input/menu/click"},
      {kUndo, kLeftHand, "/input/x/click"},
      {kPlay, kRightHand, "/input/a/click"},
      {kDuplicate, kRightHand, "/input/b/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/hp/mixed_reality_controller",
     "HP Reverb G2",
     "XR_EXT_hp_mixed_reality_controller",
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/squeeze/value"},
      {kStick, kBoth, "/input/thumbstick"},
      {kMenu, kLeftHand, "/input/y/click"},
      {kMenu, kBoth, "/input/menu/click"},
      {kUndo, kLeftHand, "/input/x/click"},
      {kPlay, kRightHand, "/input/a/click"},
      {kDuplicate, kRightHand, "/input/b/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/ml/ml2_controller",
     "Magic Leap 2",
     "XR_ML_ml2_controller_interaction",
     true,
     true,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/trigger/value"},
      {kGrab, kBoth, "/input/shoulder/click"},
      {kStick, kBoth, "/input/trackpad"},
      {kPadClick, kBoth, "/input/trackpad/click"},
      {kMenu, kBoth, "/input/menu/click"},
      {kHaptic, kBoth, "/output/haptic"}}},
    {"/interaction_profiles/microsoft/hand_interaction",
     "Bare hands",
     XR_MSFT_HAND_INTERACTION_EXTENSION_NAME,
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/select/value"},
      {kGrab, kBoth, "/input/squeeze/value"}},
     true},
    {"/interaction_profiles/ext/hand_interaction_ext",
     "Bare hands",
     kHandInteraction,
     true,
     false,
     {{kAim, kBoth, "/input/aim/pose"},
      {kGrip, kBoth, "/input/grip/pose"},
      {kSelect, kBoth, "/input/aim_activate_ext/value"},
      {kGrab, kBoth, "/input/grasp_ext/value"}},
     true},
};

}  // namespace

const std::array<TrackerRole, kTrackers> kTrackerRoles = {
    {{"/user/vive_tracker_htcx/role/waist", motion::Joint::kPelvis},
     {"/user/vive_tracker_htcx/role/right_shoulder", motion::Joint::kRightShoulder},
     {"/user/vive_tracker_htcx/role/right_elbow", motion::Joint::kRightElbow},
     {"/user/vive_tracker_htcx/role/left_shoulder", motion::Joint::kLeftShoulder},
     {"/user/vive_tracker_htcx/role/left_elbow", motion::Joint::kLeftElbow},
     {"/user/vive_tracker_htcx/role/right_knee", motion::Joint::kRightKnee},
     {"/user/vive_tracker_htcx/role/right_foot", motion::Joint::kRightAnkle},
     {"/user/vive_tracker_htcx/role/left_knee", motion::Joint::kLeftKnee},
     {"/user/vive_tracker_htcx/role/left_foot", motion::Joint::kLeftAnkle}}};

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
        case kPadClick:
            return {"pad_click", "Press the pad", ActionKind::kButton};
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

}  // namespace neuvv::xr
