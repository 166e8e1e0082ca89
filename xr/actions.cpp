#include "xr/actions.h"

#include <algorithm>
#include <cstring>

namespace neuvv::xr {

namespace {

constexpr const char* kHandPaths[kHands] = {"/user/hand/left", "/user/hand/right"};

XrActionType type_of(ActionKind kind) {
    switch (kind) {
        case ActionKind::kPose:
            return XR_ACTION_TYPE_POSE_INPUT;
        case ActionKind::kValue:
            return XR_ACTION_TYPE_FLOAT_INPUT;
        case ActionKind::kAxes:
            return XR_ACTION_TYPE_VECTOR2F_INPUT;
        case ActionKind::kButton:
            return XR_ACTION_TYPE_BOOLEAN_INPUT;
        case ActionKind::kOutput:
            return XR_ACTION_TYPE_VIBRATION_OUTPUT;
    }
    return XR_ACTION_TYPE_BOOLEAN_INPUT;
}

bool is_bound(BoundHands hands, int hand) {
    return hands == BoundHands::kBoth || (hands == BoundHands::kLeftHand) == (hand == kLeft);
}

}  // namespace

Actions::Actions(const Session& session, bool with_gaze) : session_(session) {
    create_actions();
    create_tracker_action();
    if (with_gaze) create_gaze_action();
    suggest_bindings();
    const XrActionSet set = set_.get();
    const XrSessionActionSetsAttachInfo info{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set};
    check(xrAttachSessionActionSets(session.handle(), &info), "xrAttachSessionActionSets", "stage");
    create_spaces();
}

void Actions::create_actions() {
    const Runtime& runtime = session_.runtime();
    XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO};
    std::strcpy(set.actionSetName, "stage");
    std::strcpy(set.localizedActionSetName, "On stage");
    check(xrCreateActionSet(runtime.instance(), &set, set_.out()), "xrCreateActionSet", "stage");
    for (int hand = 0; hand < kHands; ++hand) paths_[hand] = runtime.path(kHandPaths[hand]);
    for (const HandAction which : kHandActions) {
        const ActionName name = name_of(which);
        XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
        std::strcpy(info.actionName, name.name);
        std::strcpy(info.localizedActionName, name.title);
        info.actionType = type_of(name.kind);
        info.countSubactionPaths = kHands;
        info.subactionPaths = paths_.data();
        check(xrCreateAction(set_.get(), &info, &actions_[which]), "xrCreateAction", name.name);
    }
}

// A runtime may know other roles than the table's; without the action there are no trackers.
void Actions::create_tracker_action() {
    const Runtime& runtime = session_.runtime();
    if (!runtime.supports(XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME)) return;
    for (size_t i = 0; i < kTrackers; ++i) tracker_paths_[i] = runtime.path(kTrackerRoles[i].path);
    XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
    std::strcpy(info.actionName, "tracker");
    std::strcpy(info.localizedActionName, "Worn tracker");
    info.actionType = XR_ACTION_TYPE_POSE_INPUT;
    info.countSubactionPaths = kTrackers;
    info.subactionPaths = tracker_paths_.data();
    if (!succeeded(xrCreateAction(set_.get(), &info, &tracker_), "xrCreateAction", info.actionName))
        tracker_ = XR_NULL_HANDLE;
}

void Actions::create_gaze_action() {
    if (!session_.runtime().supports(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME)) return;
    XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
    std::strcpy(info.actionName, "gaze");
    std::strcpy(info.localizedActionName, "Gaze");
    info.actionType = XR_ACTION_TYPE_POSE_INPUT;
    if (!succeeded(xrCreateAction(set_.get(), &info, &gaze_), "xrCreateAction", info.actionName))
        gaze_ = XR_NULL_HANDLE;
}

std::vector<XrActionSuggestedBinding> Actions::tracker_bindings() const {
    std::vector<XrActionSuggestedBinding> bindings;
    for (const TrackerRole& role : kTrackerRoles)
        bindings.push_back({tracker_, session_.runtime().path((std::string(role.path) + kTrackerPose).c_str())});
    return bindings;
}

// A runtime may not know every controller of the table: XR_ERROR_PATH_UNSUPPORTED is no failure.
void Actions::suggest(const char* profile, const char* title,
                      const std::vector<XrActionSuggestedBinding>& bindings) const {
    XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
    info.interactionProfile = session_.runtime().path(profile);
    info.countSuggestedBindings = static_cast<uint32_t>(bindings.size());
    info.suggestedBindings = bindings.data();
    const XrResult result = xrSuggestInteractionProfileBindings(session_.runtime().instance(), &info);
    if (result != XR_ERROR_PATH_UNSUPPORTED) check(result, "xrSuggestInteractionProfileBindings", title);
}

void Actions::suggest_bindings() const {
    const Runtime& runtime = session_.runtime();
    for (const ControllerProfile& profile : controller_profiles()) {
        if (profile.extension && !runtime.has(profile.extension)) continue;
        std::vector<XrActionSuggestedBinding> bindings;
        for (const Binding& one : profile.bindings)
            for (int hand = 0; hand < kHands; ++hand)
                if (is_bound(one.hands, hand))
                    bindings.push_back(
                        {action(one.action), runtime.path((std::string(kHandPaths[hand]) + one.path).c_str())});
        suggest(profile.path, profile.title, bindings);
    }
    if (tracker_ != XR_NULL_HANDLE) suggest(kTrackerProfile, "trackers", tracker_bindings());
    if (gaze_ != XR_NULL_HANDLE) suggest(kGazeProfile, "gaze", {{gaze_, runtime.path(kGazePose)}});
}

void Actions::create_spaces() {
    const auto create = [&](XrAction action, XrPath path, XrOwnedSpace& space, const char* name) {
        XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO};
        info.action = action;
        info.subactionPath = path;
        info.poseInActionSpace = xr_pose({});
        check(xrCreateActionSpace(session_.handle(), &info, space.out()), "xrCreateActionSpace", name);
    };
    for (int hand = 0; hand < kHands; ++hand)
        for (const auto& [which, spaces] : {std::pair{HandAction::kAim, &aim_}, std::pair{HandAction::kGrip, &grip_}})
            create(action(which), paths_[hand], (*spaces)[hand], name_of(which).name);
    if (gaze_ != XR_NULL_HANDLE) create(gaze_, XR_NULL_PATH, gaze_space_, "gaze");
    if (tracker_ == XR_NULL_HANDLE) return;
    for (size_t i = 0; i < kTrackers; ++i) create(tracker_, tracker_paths_[i], trackers_[i], "tracker");
}

void Actions::update_controllers() {
    for (int hand = 0; hand < kHands; ++hand) {
        XrInteractionProfileState state{XR_TYPE_INTERACTION_PROFILE_STATE};
        check(xrGetCurrentInteractionProfile(session_.handle(), paths_[hand], &state), "xrGetCurrentInteractionProfile",
              kHandPaths[hand]);
        profile_paths_[hand] = session_.runtime().text_of(state.interactionProfile);
        profiles_[hand] = find_profile(profile_paths_[hand]);
        for (const HandAction which : kHandActions) button_names_[hand][which] = find_button_name(which, hand);
    }
}

// A runtime that refuses leaves the button without a name.
std::string Actions::find_button_name(HandAction which, int hand) const {
    XrPath sources[16]{};
    uint32_t count = 0;
    const XrBoundSourcesForActionEnumerateInfo bound{XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO, nullptr,
                                                     action(which)};
    if (!succeeded(xrEnumerateBoundSourcesForAction(session_.handle(), &bound, std::size(sources), &count, sources),
                   "xrEnumerateBoundSourcesForAction", name_of(which).name))
        return {};
    const std::string below = std::string(kHandPaths[hand]) + "/";
    for (const XrPath source : std::span(sources, count)) {
        if (!session_.runtime().text_of(source).starts_with(below)) continue;
        char name[256]{};
        uint32_t length = 0;
        const XrInputSourceLocalizedNameGetInfo info{XR_TYPE_INPUT_SOURCE_LOCALIZED_NAME_GET_INFO, nullptr, source,
                                                     XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT};
        const bool has_name =
            succeeded(xrGetInputSourceLocalizedName(session_.handle(), &info, std::size(name) - 1, &length, name),
                      "xrGetInputSourceLocalizedName", name_of(which).name);
        return has_name ? name : "";
    }
    return {};
}

std::string Actions::controller(int hand) const {
    return profiles_[hand] ? profiles_[hand]->title : profile_paths_[hand];
}

double Actions::value(HandAction which, int hand) const {
    const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action(which), paths_[hand]};
    XrActionStateFloat state{XR_TYPE_ACTION_STATE_FLOAT};
    check(xrGetActionStateFloat(session_.handle(), &info, &state), "xrGetActionStateFloat", name_of(which).name);
    return state.isActive ? state.currentState : 0;
}

glm::dvec2 Actions::axes(HandAction which, int hand) const {
    const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action(which), paths_[hand]};
    XrActionStateVector2f state{XR_TYPE_ACTION_STATE_VECTOR2F};
    check(xrGetActionStateVector2f(session_.handle(), &info, &state), "xrGetActionStateVector2f", name_of(which).name);
    return state.isActive ? glm::dvec2(state.currentState.x, state.currentState.y) : glm::dvec2(0);
}

bool Actions::button(HandAction which, int hand, bool* changed) const {
    const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action(which), paths_[hand]};
    XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN};
    check(xrGetActionStateBoolean(session_.handle(), &info, &state), "xrGetActionStateBoolean", name_of(which).name);
    if (changed) *changed = state.isActive && state.changedSinceLastSync;
    return state.isActive && state.currentState;
}

bool Actions::pressed(HandAction which, int hand) const {
    bool changed = false;
    return button(which, hand, &changed) && changed;
}

HandInputs Actions::sample(XrTime time) {
    HandInputs hands;
    const XrActiveActionSet active{set_.get(), XR_NULL_PATH};
    const XrActionsSyncInfo info{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
    const XrResult result = check(xrSyncActions(session_.handle(), &info), "xrSyncActions", "stage");
    if (result == XR_SESSION_NOT_FOCUSED || result == XR_SESSION_LOSS_PENDING) return hands;
    for (int hand = 0; hand < kHands; ++hand) {
        HandInput& input = hands[hand];
        input.aim = session_.locate(aim_[hand].get(), time);
        input.grip = session_.locate(grip_[hand].get(), time);
        input.select = value(HandAction::kSelect, hand);
        input.grab = value(HandAction::kGrab, hand);
        const bool clicked = button(HandAction::kPadClick, hand);
        const bool touch_pad = profiles_[hand] && profiles_[hand]->has_touch_pad;
        if (!touch_pad || clicked) input.stick = axes(HandAction::kStick, hand);
        input.menu = pressed(HandAction::kMenu, hand);
        input.play = pressed(HandAction::kPlay, hand);
        input.undo = pressed(HandAction::kUndo, hand);
        input.duplicate = pressed(HandAction::kDuplicate, hand);
        input.lacks_menu =
            profiles_[hand] && std::none_of(profiles_[hand]->bindings.begin(), profiles_[hand]->bindings.end(),
                                            [](const Binding& b) { return b.action == HandAction::kMenu; });
        input.bare_hand = profiles_[hand] && profiles_[hand]->is_hand;
        input.has_grab = !profiles_[hand] || profiles_[hand]->has_grab;
    }
    return hands;
}

TrackerPositions Actions::locate_trackers(XrTime time) const {
    TrackerPositions positions;
    if (tracker_ == XR_NULL_HANDLE) return positions;
    for (size_t i = 0; i < kTrackers; ++i)
        if (const auto pose = session_.locate(trackers_[i].get(), time)) positions[i] = pose->position;
    return positions;
}

std::optional<Pose> Actions::locate_gaze(XrTime time) const {
    if (gaze_ == XR_NULL_HANDLE) return std::nullopt;
    return session_.locate(gaze_space_.get(), time);
}

void Actions::vibrate(int hand, double amplitude, double seconds) {
    XrHapticVibration vibration{XR_TYPE_HAPTIC_VIBRATION};
    vibration.amplitude = static_cast<float>(std::clamp(amplitude, 0.0, 1.0));
    vibration.duration = static_cast<XrDuration>(seconds * 1e9);
    vibration.frequency = XR_FREQUENCY_UNSPECIFIED;
    const XrHapticActionInfo info{XR_TYPE_HAPTIC_ACTION_INFO, nullptr, action(HandAction::kHaptic), paths_[hand]};
    succeeded(xrApplyHapticFeedback(session_.handle(), &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration)),
              "xrApplyHapticFeedback", kHandPaths[hand]);
}

}  // namespace neuvv::xr
