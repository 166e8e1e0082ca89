// What buttons do, and where they are on each kind of controller: data.
#pragma once

#include <string_view>
#include <vector>

namespace neuvv::xr {

// What a user does, whichever button that is. Those of one hand are asked of both.
enum class HandAction {
    kAim,       // pose: where the hand points
    kGrip,      // pose: where it holds things
    kSelect,    // 0..1: takes what is pointed at, paints, presses panels
    kGrab,      // 0..1: holds what is pointed at
    kStick,     // two axes −1..1
    kPadClick,  // how sticks are told from touch pads, which rest under a thumb
    kMenu,      // shows and hides the panel
    kPlay,
    kUndo,
    kDuplicate,
    kHaptic,  // to the hand
};
constexpr HandAction kHandActions[] = {HandAction::kAim,       HandAction::kGrip,  HandAction::kSelect,
                                       HandAction::kGrab,      HandAction::kStick, HandAction::kPadClick,
                                       HandAction::kMenu,      HandAction::kPlay,  HandAction::kUndo,
                                       HandAction::kDuplicate, HandAction::kHaptic};

enum class ActionKind { kPose, kValue, kAxes, kButton, kOutput };

struct ActionName {
    const char* name;   // as OpenXR wants it
    const char* title;  // as people read it in a runtime's menus
    ActionKind kind;
};
ActionName name_of(HandAction action);

enum class BoundHands { kLeftHand, kRightHand, kBoth };

struct Binding {
    HandAction action;
    BoundHands hands;
    const char* path;  // below the hand's: "/input/trigger/value"
};

struct ControllerProfile {
    const char* path;       // "/interaction_profiles/oculus/touch_controller"
    const char* title;      // "Meta Touch"
    const char* extension;  // that defines it; null: OpenXR itself
    bool has_grab;          // else what is selected for long is grabbed
    bool has_touch_pad;     // in place of a stick: it counts while it is pressed
    std::vector<Binding> bindings;
    bool is_hand = false;  // nothing is held: the hand itself
};
// Of OpenXR 1.0.28 and later; there is nothing to it but its name and paths.
constexpr const char* kHandInteraction = "XR_EXT_hand_interaction";
const std::vector<ControllerProfile>& controller_profiles();
// The one of this path; null: none of ours.
const ControllerProfile* find_profile(std::string_view path);

}  // namespace neuvv::xr
