// Violations: action sets, actions, bindings, and attaching them to a session.
#include <cstring>

#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

XrResult create_set(Application& app, const char* name, const char* localized) {
    app.make_actions();
    XrActionSetCreateInfo info = {XR_TYPE_ACTION_SET_CREATE_INFO};
    std::strcpy(info.actionSetName, name);
    std::strcpy(info.localizedActionSetName, localized);
    XrActionSet set = XR_NULL_HANDLE;
    return xrCreateActionSet(app.instance, &info, &set);
}

XrResult endless_name(Application& app) {
    app.make_actions();
    XrActionSetCreateInfo info = {XR_TYPE_ACTION_SET_CREATE_INFO};
    std::memset(info.actionSetName, 'a', sizeof info.actionSetName);
    XrActionSet set = XR_NULL_HANDLE;
    return xrCreateActionSet(app.instance, &info, &set);
}

template <auto kAlter>
XrResult create_action(Application& app) {
    app.make_actions();
    XrActionCreateInfo info = app.action_info("another", XR_ACTION_TYPE_FLOAT_INPUT);
    kAlter(info);
    XrAction action = XR_NULL_HANDLE;
    return xrCreateAction(app.action_set, &info, &action);
}

void taken_name(XrActionCreateInfo& info) {
    std::strcpy(info.actionName, "press");
}
void no_localized_name(XrActionCreateInfo& info) {
    info.localizedActionName[0] = 0;
}
void unknown_type(XrActionCreateInfo& info) {
    info.actionType = XrActionType(77);
}
void no_subaction_paths(XrActionCreateInfo& info) {
    info.subactionPaths = nullptr;
}

XrResult create_action_for(Application& app, std::array<const char*, 2> paths) {
    app.make_actions();
    XrActionCreateInfo info = app.action_info("another", XR_ACTION_TYPE_FLOAT_INPUT);
    const XrPath both[] = {app.path(paths[0]), app.path(paths[1])};
    info.subactionPaths = both;
    XrAction action = XR_NULL_HANDLE;
    return xrCreateAction(app.action_set, &info, &action);
}

XrResult create_action_too_late(Application& app) {
    app.attach_actions();
    const XrActionCreateInfo info = app.action_info("another", XR_ACTION_TYPE_FLOAT_INPUT);
    XrAction action = XR_NULL_HANDLE;
    return xrCreateAction(app.action_set, &info, &action);
}

// --- Bindings ---

constexpr const char* kTouch = "/interaction_profiles/oculus/touch_controller";

XrResult suggest(Application& app, const char* profile, XrAction action, const char* path) {
    const XrActionSuggestedBinding binding = {action, app.path(path)};
    const XrInteractionProfileSuggestedBinding info = {XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                       app.path(profile), 1, &binding};
    return xrSuggestInteractionProfileBindings(app.instance, &info);
}

XrResult bind_press(Application& app, const char* profile, const char* path) {
    app.make_actions();
    return suggest(app, profile, app.press, path);
}

XrResult bind_pose_to_trigger(Application& app) {
    app.make_actions();
    return suggest(app, kTouch, app.grip, "/user/hand/left/input/trigger/value");
}

XrResult bind_right_hand_to_left(Application& app) {
    app.make_actions();
    XrActionCreateInfo info = app.action_info("another", XR_ACTION_TYPE_FLOAT_INPUT);
    info.countSubactionPaths = 1;  // the left hand
    XrAction left = XR_NULL_HANDLE;
    check(xrCreateAction(app.action_set, &info, &left), "xrCreateAction");
    return suggest(app, kTouch, left, "/user/hand/right/input/trigger/value");
}

XrResult bind_nothing(Application& app) {
    app.make_actions();
    const XrInteractionProfileSuggestedBinding info = {XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                       app.path(kTouch), 0, nullptr};
    return xrSuggestInteractionProfileBindings(app.instance, &info);
}

XrResult bind_twice(Application& app) {
    app.suggest_bindings();
    return suggest(app, kTouch, app.press, "/user/hand/left/input/trigger/value");
}

XrResult bind_too_late(Application& app) {
    app.attach_actions();
    return suggest(app, kTouch, app.press, "/user/hand/left/input/trigger/value");
}

// --- Attaching ---

XrResult attach(Application& app, uint32_t count) {
    const XrSessionActionSetsAttachInfo info = {XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, count,
                                                &app.action_set};
    return xrAttachSessionActionSets(app.session, &info);
}

XrResult attach_twice(Application& app) {
    app.attach_actions();
    return attach(app, 1);
}

XrResult attach_nothing(Application& app) {
    app.make_session();
    app.make_actions();
    return attach(app, 0);
}

}  // namespace

std::vector<Violation> action_violations() {
    using App = Application;
    const char *set = "xrCreateActionSet", *action = "xrCreateAction", *bind = "xrSuggestInteractionProfileBindings";
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE, unsupported = XR_ERROR_PATH_UNSUPPORTED;
    const XrResult attached = XR_ERROR_ACTIONSETS_ALREADY_ATTACHED;
    const Severity warning = Severity::kWarning;
    return {
        {"NoName", "name", set, XR_ERROR_NAME_INVALID, [](App& app) { return create_set(app, "", "More"); }},
        {"NoLocalizedName", "name", set, XR_ERROR_LOCALIZED_NAME_INVALID,
         [](App& app) { return create_set(app, "more", ""); }},
        {"NameWithCapitals", "name", set, XR_ERROR_PATH_FORMAT_INVALID,
         [](App& app) { return create_set(app, "More", "More"); }},
        {"TakenName", "name", set, XR_ERROR_NAME_DUPLICATED, [](App& app) { return create_set(app, "main", "More"); }},
        {"TakenLocalizedName", "name", set, XR_ERROR_LOCALIZED_NAME_DUPLICATED,
         [](App& app) { return create_set(app, "more", "Main"); }},
        {"EndlessName", "name", set, invalid, endless_name},
        {"TakenNameOfAction", "name", action, XR_ERROR_NAME_DUPLICATED, create_action<taken_name>},
        {"NoLocalizedNameOfAction", "name", action, XR_ERROR_LOCALIZED_NAME_INVALID, create_action<no_localized_name>},
        {"UnknownType", "enum", action, invalid, create_action<unknown_type>},
        {"NoSubactionPaths", "null", action, invalid, create_action<no_subaction_paths>},
        {"SubactionPathOfNobody", "subaction-path", action, unsupported,
         [](App& app) {
             return create_action_for(app, {"/user/hand/left", "/user/hand/left/input"});
         }},
        {"SubactionPathTwice", "subaction-path", action, unsupported,
         [](App& app) {
             return create_action_for(app, {"/user/hand/left", "/user/hand/left"});
         }},
        {"MadeTooLate", "action-order", action, attached, create_action_too_late},
        {"BoundToUnknownInput", "binding", bind, unsupported,
         [](App& app) { return bind_press(app, kTouch, "/user/hand/left/input/wheel/click"); }},
        {"BoundToInputOfTheOtherHand", "binding", bind, unsupported,
         [](App& app) { return bind_press(app, kTouch, "/user/hand/left/input/a/click"); }},
        {"PoseBoundToTrigger", "binding", bind, unsupported, bind_pose_to_trigger},
        {"BoundBesideItsSubactionPath", "binding", bind, XR_SUCCESS, bind_right_hand_to_left, warning},
        {"NothingBound", "binding", bind, invalid, bind_nothing},
        {"BoundTwice", "binding", bind, XR_SUCCESS, bind_twice, warning},
        {"BoundTooLate", "action-order", bind, attached, bind_too_late},
        {"UnknownProfile", "profile", bind, unsupported,
         [](App& app) {
             return bind_press(app, "/interaction_profiles/acme/wand", "/user/hand/left/input/trigger/value");
         },
         warning},
        {"ProfileWithoutExtension", "extension", bind, unsupported,
         [](App& app) {
             return bind_press(app, "/interaction_profiles/microsoft/hand_interaction",
                               "/user/hand/left/input/select/value");
         }},
        {"AttachedTwice", "action-order", "xrAttachSessionActionSets", attached, attach_twice},
        {"NothingAttached", "action-order", "xrAttachSessionActionSets", invalid, attach_nothing},
    };
}

}  // namespace neuvv::test
