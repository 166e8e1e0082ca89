// What the program's actions are, and which button of each kind of controller triggers them: plain data.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "motion/skeleton/joints.h"

namespace neuvv::xr {

// What a user does, independent of the button. Each action is queried for both hands.
enum class HandAction {
    kAim,       // pose: origin and direction of the pointer ray
    kGrip,      // pose: where the hand holds the controller
    kSelect,    // 0..1, trigger: selects what the ray hits, paints, presses the panel
    kGrab,      // 0..1, squeeze: grabs what the ray hits
    kStick,     // two axes, −1..1
    kPadClick,  // touch pads only: a thumb that rests on the pad counts only while the pad is pressed
    kMenu,      // shows and hides the panel
    kPlay,
    kUndo,
    kDuplicate,
    kHaptic,  // output: vibration
};
constexpr HandAction kHandActions[] = {HandAction::kAim,       HandAction::kGrip,  HandAction::kSelect,
                                       HandAction::kGrab,      HandAction::kStick, HandAction::kPadClick,
                                       HandAction::kMenu,      HandAction::kPlay,  HandAction::kUndo,
                                       HandAction::kDuplicate, HandAction::kHaptic};

enum class ActionKind { kPose, kValue, kAxes, kButton, kOutput };

struct ActionName {
    const char* name;   // for OpenXR: lower case, digits and underscores
    const char* title;  // for people, in a runtime's menus
    ActionKind kind;
};
ActionName name_of(HandAction action);

enum class BoundHands { kLeftHand, kRightHand, kBoth };

struct Binding {
    HandAction action;
    BoundHands hands;
    const char* path;  // below the path of the hand: "/input/trigger/value"
};

// An interaction profile of OpenXR, with the bindings that this program suggests for it.
struct ControllerProfile {
    const char* path;       // "/interaction_profiles/oculus/touch_controller"
    const char* title;      // "Meta Touch"
    const char* extension;  // the extension that defines the profile; null where the core of OpenXR does
    bool has_grab;          // without a grab button, a long press of select grabs
    bool has_touch_pad;     // a touch pad in place of a stick: its position counts while it is pressed
    std::vector<Binding> bindings;
    bool is_hand = false;  // a bare hand that holds no controller
};
// The headers of OpenXR define this extension from 1.0.28 on; only its name and its paths are needed.
constexpr const char* kHandInteraction = "XR_EXT_hand_interaction";
const std::vector<ControllerProfile>& controller_profiles();
// Trackers that are worn (XR_HTCX_vive_tracker_interaction), and the joints that they are worn at. A tracker on the
// chest is none of them, as no joint is there.
struct TrackerRole {
    const char* path;
    motion::Joint joint;
};
constexpr size_t kTrackers = 9;
extern const std::array<TrackerRole, kTrackers> kTrackerRoles;
constexpr const char* kTrackerProfile = "/interaction_profiles/htc/vive_tracker_htcx";
constexpr const char* kTrackerPose = "/input/grip/pose";  // below the path of the role

// Where the eyes look (XR_EXT_eye_gaze_interaction): a pose with its origin between the eyes, whose −Z is the gaze.
constexpr const char* kGazeProfile = "/interaction_profiles/ext/eye_gaze_interaction";
constexpr const char* kGazePose = "/user/eyes_ext/input/gaze_ext/pose";

// The profile with this path; null where the table has none.
const ControllerProfile* find_profile(std::string_view path);

}  // namespace neuvv::xr
