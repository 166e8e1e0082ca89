// Creating action sets and actions, and attaching them to a session.
#include "call.h"
#include "profiles.h"

namespace neuvv::xr_runtime {

namespace {

// The rules of the specification's section "Well-Formed Path Strings" for a single name.
void check_name(const std::string& name, const char* what) {
    require(!name.empty(), XR_ERROR_NAME_INVALID, "name", fmt::format("the {} must not be empty", what));
    for (const char c : name) {
        const bool is_allowed = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
        require(is_allowed, XR_ERROR_PATH_FORMAT_INVALID, "name",
                fmt::format("the {} '{}' may have a-z, 0-9, '-', '_' and '.' only", what, name));
    }
}

template <size_t kSize>
std::string text_in(const char (&buffer)[kSize], const char* what) {
    const size_t length = strnlen(buffer, kSize);
    require(length < kSize, XR_ERROR_VALIDATION_FAILURE, "name", fmt::format("the {} does not end", what));
    return {buffer, length};
}

template <typename T>
void check_unique(const T& made, const T& other, const char* what) {
    require(made.name != other.name, XR_ERROR_NAME_DUPLICATED, "name",
            fmt::format("there is another {} named '{}'", what, made.name));
    require(made.localized_name != other.localized_name, XR_ERROR_LOCALIZED_NAME_DUPLICATED, "name",
            fmt::format("there is another {} with the localized name '{}'", what, made.localized_name));
}

XrResult create_action_set(XrInstance handle, const XrActionSetCreateInfo* create_info, XrActionSet* out) {
    instance_of(handle);
    const XrActionSetCreateInfo& info = checked(create_info);
    check_pointer(out, "actionSet");
    ActionSet made;
    made.name = text_in(info.actionSetName, "actionSetName");
    made.localized_name = text_in(info.localizedActionSetName, "localizedActionSetName");
    made.priority = info.priority;
    check_name(made.name, "actionSetName");
    require(!made.localized_name.empty(), XR_ERROR_LOCALIZED_NAME_INVALID, "name",
            "the localizedActionSetName must not be empty");
    for (const auto& other : all_of<ActionSet>()) check_unique(made, *other, "action set");
    const auto set = make_object<ActionSet>();
    made.handle = set->handle;
    *set = made;
    *out = set->handle;
    return XR_SUCCESS;
}

XrResult destroy_action_set(XrActionSet handle) {
    const auto set = shared<ActionSet>(handle);
    for (const auto& action : all_of<Action>())
        if (action->set == set) forget(bits(action->handle));
    forget(bits(handle));
    return XR_SUCCESS;
}

void check_declared_paths(const Action& action) {
    std::set<XrPath> seen;
    for (const XrPath path : action.subaction_paths) {
        const std::string& text = text_of(path);
        const bool is_tracker =
            text.starts_with(kTrackerRoot) && runtime().instance->has(XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME);
        require(is_tracker || text == "/user/hand/left" || text == "/user/hand/right" || text == "/user/head" ||
                    text == "/user/gamepad" || text == "/user/treadmill",
                XR_ERROR_PATH_UNSUPPORTED, "subaction-path", fmt::format("'{}' is no top level user path", text));
        require(seen.insert(path).second, XR_ERROR_PATH_UNSUPPORTED, "subaction-path",
                fmt::format("the action '{}' has the subaction path {} twice", action.name, text));
    }
}

XrResult create_action(XrActionSet set_handle, const XrActionCreateInfo* create_info, XrAction* out) {
    const auto set = shared<ActionSet>(set_handle);
    const XrActionCreateInfo& info = checked(create_info);
    check_pointer(out, "action");
    require(!set->is_attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action-order",
            fmt::format("the action set '{}' is attached to a session: it gets no more actions", set->name));
    Action made;
    made.set = set;
    made.name = text_in(info.actionName, "actionName");
    made.localized_name = text_in(info.localizedActionName, "localizedActionName");
    check_name(made.name, "actionName");
    require(!made.localized_name.empty(), XR_ERROR_LOCALIZED_NAME_INVALID, "name",
            "the localizedActionName must not be empty");
    const bool is_type =
        (info.actionType >= XR_ACTION_TYPE_BOOLEAN_INPUT && info.actionType <= XR_ACTION_TYPE_POSE_INPUT) ||
        info.actionType == XR_ACTION_TYPE_VIBRATION_OUTPUT;
    require(is_type, XR_ERROR_VALIDATION_FAILURE, "enum", "actionType is no XrActionType");
    made.type = info.actionType;
    if (info.countSubactionPaths) check_pointer(info.subactionPaths, "subactionPaths");
    made.subaction_paths.assign(info.subactionPaths, info.subactionPaths + info.countSubactionPaths);
    check_declared_paths(made);
    for (const auto& other : all_of<Action>())
        if (other->set == set) check_unique(made, *other, "action of the set");
    const auto action = make_object<Action>();
    made.handle = action->handle;
    *action = made;
    *out = action->handle;
    return XR_SUCCESS;
}

XrResult destroy_action(XrAction handle) {
    shared<Action>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

}  // namespace

void check_subaction(const Action& action, XrPath path) {
    if (path == XR_NULL_PATH) return;
    const std::string& text = text_of(path);
    const auto& declared = action.subaction_paths;
    require(std::find(declared.begin(), declared.end(), path) != declared.end(), XR_ERROR_PATH_UNSUPPORTED,
            "subaction-path", fmt::format("the action '{}' was not created with '{}'", action.name, text));
}

std::vector<EntryPoint> action_entries() {
    return {NEUVV_XR_ENTRY(xrCreateActionSet, create_action_set),
            NEUVV_XR_ENTRY(xrDestroyActionSet, destroy_action_set), NEUVV_XR_ENTRY(xrCreateAction, create_action),
            NEUVV_XR_ENTRY(xrDestroyAction, destroy_action)};
}

}  // namespace neuvv::xr_runtime
