// xrSyncActions, the action states that it updates, and haptics.
#include <cmath>

#include "bindings.h"
#include "call.h"
#include "profiles.h"
#include "session.h"

namespace neuvv::xr_runtime {

namespace {

constexpr float kPressed = 0.5f;  // threshold of an analogue input that a boolean action reads

std::optional<XrVector2f> scripted(const std::string& path) {
    const auto& inputs = runtime().script.inputs;
    const auto found = inputs.find(path);
    if (found == inputs.end()) return std::nullopt;
    return value_at(found->second, runtime().progress.frame(), XrVector2f{0, 0});
}

// Inputs that the script does not set follow from other inputs of the same part, as on a real controller: a pulled
// trigger is touched, a fully pulled one clicks, and the simple profile's select is the trigger.
XrVector2f input_value(const std::string& path) {
    if (const auto value = scripted(path)) return *value;
    const std::string part = path.substr(0, path.rfind('/')), component = path.substr(part.size());
    const auto value = scripted(part + "/value"), click = scripted(part + "/click"), stick = scripted(part);
    if (component == "/click" && value) return {value->x >= 0.99f ? 1.0f : 0.0f, 0};
    if (component == "/value" && click) return *click;
    if (component == "/touch") {
        const bool is_held =
            (value && value->x > 0) || (click && click->x > 0) || (stick && (stick->x != 0 || stick->y != 0));
        return {is_held ? 1.0f : 0.0f, 0};
    }
    if (part.ends_with("/select")) {
        const std::string trigger = part.substr(0, part.size() - sizeof "select" + 1) + "trigger";
        const auto pull = scripted(trigger + "/value");
        const bool is_click = component == "/click";
        if (pull) return {is_click ? (pull->x > kPressed ? 1.0f : 0.0f) : pull->x, 0};
        if (const auto pressed = scripted(trigger + "/click")) return *pressed;
    }
    const auto x = scripted(path + "/x"), y = scripted(path + "/y");
    return {x ? x->x : 0, y ? y->x : 0};
}

// Combines several sources of an action: the "or" of booleans, the value of largest magnitude, the longest vector.
XrVector2f combined(XrVector2f a, XrVector2f b) {
    return a.x * a.x + a.y * a.y >= b.x * b.x + b.y * b.y ? a : b;
}

// Where two active sets read the same input, the one of higher priority gets it.
using Priorities = std::map<std::string, uint32_t>;

struct ActiveSets {
    // By set: the subaction paths for which it is active; XR_NULL_PATH means all.
    std::map<const ActionSet*, std::set<XrPath>> paths;
    bool has(const ActionSet* set, const std::string& source) const {
        const auto found = paths.find(set);
        if (found == paths.end()) return false;
        for (const XrPath path : found->second)
            if (path == XR_NULL_PATH || source.starts_with(text_of(path) + "/")) return true;
        return false;
    }
};

ActionState read_sources(const Session& session, const Action& action, XrPath subaction_path, const ActiveSets& active,
                         const Priorities& priorities) {
    ActionState state;
    for (const Source& source : sources_of(session, action, subaction_path)) {
        if (!active.has(action.set.get(), source.input)) continue;
        if (priorities.at(source.input) > action.set->priority) continue;
        if (!state.is_active) state.source = source.input;
        state.is_active = true;
        XrVector2f value = input_value(source.input);
        if (action.type == XR_ACTION_TYPE_BOOLEAN_INPUT) value = {value.x > kPressed ? 1.0f : 0.0f, 0};
        state.value = combined(state.value, value);
    }
    return state;
}

// A change counts only where the action was active at both syncs.
void update(ActionState& kept, ActionState fresh) {
    const bool has_changed = kept.value.x != fresh.value.x || kept.value.y != fresh.value.y;
    fresh.has_changed = fresh.is_active && kept.is_active && has_changed;
    fresh.change_time = fresh.is_active ? kept.change_time : 0;
    if (fresh.is_active && (has_changed || !kept.is_active)) fresh.change_time = now();
    kept = fresh;
}

void sync_states(Session& session, const ActiveSets& active) {
    Priorities priorities;
    const auto actions = all_of<Action>();
    for (const auto& action : actions)
        for (const Source& source : sources_of(session, *action, XR_NULL_PATH))
            if (active.has(action->set.get(), source.input))
                priorities[source.input] = std::max(priorities[source.input], action->set->priority);
    for (const auto& action : actions) {
        std::vector<XrPath> paths = action->subaction_paths;
        paths.push_back(XR_NULL_PATH);
        for (const XrPath path : paths)
            update(session.action_states[{action->handle, path}],
                   read_sources(session, *action, path, active, priorities));
    }
}

void deactivate(Session& session) {
    session.action_states.clear();
}

// The runtime may change the profile in xrSyncActions only, and queues an event when it does.
void sync_profile(Session& session) {
    const std::string fitting = fitting_profile(*session.instance);
    if (fitting == session.current_profile) return;
    session.current_profile = fitting;
    queue_event(*session.instance, XrEventDataInteractionProfileChanged{XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED,
                                                                        nullptr, session.handle});
}

ActiveSets checked_sets(const Session& session, const XrActionsSyncInfo& info) {
    ActiveSets active;
    if (info.countActiveActionSets) check_pointer(info.activeActionSets, "activeActionSets");
    for (uint32_t i = 0; i < info.countActiveActionSets; ++i) {
        const XrActiveActionSet& entry = info.activeActionSets[i];
        const auto set = shared<ActionSet>(entry.actionSet);
        const auto& attached = session.attached;
        require(std::find(attached.begin(), attached.end(), set) != attached.end(), XR_ERROR_ACTIONSET_NOT_ATTACHED,
                "action-order",
                fmt::format("xrSyncActions with the action set '{}', which is not attached", set->name));
        if (entry.subactionPath != XR_NULL_PATH) {
            bool is_declared = false;
            for (const auto& action : all_of<Action>())
                is_declared = is_declared ||
                              (action->set == set && std::count(action->subaction_paths.begin(),
                                                                action->subaction_paths.end(), entry.subactionPath));
            require(is_declared, XR_ERROR_PATH_UNSUPPORTED, "subaction-path",
                    fmt::format("no action of the set '{}' has the subaction path {}", set->name,
                                text_of(entry.subactionPath)));
        }
        active.paths[set.get()].insert(entry.subactionPath);
    }
    return active;
}

XrResult sync_actions(XrSession handle, const XrActionsSyncInfo* sync_info) {
    Session& session = object<Session>(handle);
    const XrActionsSyncInfo& info = checked(sync_info);
    require(session.is_attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "action-order",
            "xrSyncActions before xrAttachSessionActionSets");
    const ActiveSets active = checked_sets(session, info);
    session.was_synced = true;
    if (session.state != XR_SESSION_STATE_FOCUSED) {
        deactivate(session);
        return XR_SESSION_NOT_FOCUSED;
    }
    sync_profile(session);
    sync_states(session, active);
    return XR_SUCCESS;
}

// --- States that an application reads ---

std::shared_ptr<Action> action_of(const Session& session, XrAction handle, XrPath subaction_path, XrActionType type) {
    const auto action = shared<Action>(handle);
    require(std::count(session.attached.begin(), session.attached.end(), action->set), XR_ERROR_ACTIONSET_NOT_ATTACHED,
            "action-order", fmt::format("the action set of '{}' is not attached to the session", action->name));
    require(action->type == type, XR_ERROR_ACTION_TYPE_MISMATCH, "action-type",
            fmt::format("the action '{}' is read as another type than it was created with", action->name));
    check_subaction(*action, subaction_path);
    return action;
}

ActionState state_of(XrSession handle, const XrActionStateGetInfo* get_info, XrActionType type) {
    const Session& session = object<Session>(handle);
    const XrActionStateGetInfo& info = checked(get_info);
    action_of(session, info.action, info.subactionPath, type);
    if (!session.was_synced) warn("action-order", "an action's state is read before the first xrSyncActions");
    const auto found = session.action_states.find({info.action, info.subactionPath});
    const bool is_focused = session.state == XR_SESSION_STATE_FOCUSED;
    return found == session.action_states.end() || !is_focused ? ActionState{} : found->second;
}

template <typename T>
void fill_common(T& out, const ActionState& state) {
    out.changedSinceLastSync = state.has_changed ? XR_TRUE : XR_FALSE;
    out.lastChangeTime = state.change_time;
    out.isActive = state.is_active ? XR_TRUE : XR_FALSE;
}

XrResult get_boolean(XrSession handle, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
    const ActionState state = state_of(handle, info, XR_ACTION_TYPE_BOOLEAN_INPUT);
    checked(out).currentState = state.value.x > kPressed ? XR_TRUE : XR_FALSE;
    fill_common(*out, state);
    return XR_SUCCESS;
}

XrResult get_float(XrSession handle, const XrActionStateGetInfo* info, XrActionStateFloat* out) {
    const ActionState state = state_of(handle, info, XR_ACTION_TYPE_FLOAT_INPUT);
    checked(out).currentState = state.value.x;
    fill_common(*out, state);
    return XR_SUCCESS;
}

XrResult get_vector(XrSession handle, const XrActionStateGetInfo* info, XrActionStateVector2f* out) {
    const ActionState state = state_of(handle, info, XR_ACTION_TYPE_VECTOR2F_INPUT);
    checked(out).currentState = state.value;
    fill_common(*out, state);
    return XR_SUCCESS;
}

XrResult get_pose(XrSession handle, const XrActionStateGetInfo* info, XrActionStatePose* out) {
    checked(out).isActive = state_of(handle, info, XR_ACTION_TYPE_POSE_INPUT).is_active ? XR_TRUE : XR_FALSE;
    return XR_SUCCESS;
}

// The outputs that an XrHapticActionInfo means.
std::vector<Source> haptic_sources(const Session& session, const XrHapticActionInfo& info) {
    const auto action = action_of(session, info.action, info.subactionPath, XR_ACTION_TYPE_VIBRATION_OUTPUT);
    return sources_of(session, *action, info.subactionPath);
}

XrResult apply_haptic(XrSession handle, const XrHapticActionInfo* haptic_info, const XrHapticBaseHeader* feedback) {
    const Session& session = object<Session>(handle);
    const auto sources = haptic_sources(session, checked(haptic_info));
    check_pointer(feedback, "hapticFeedback");
    const XrHapticVibration& vibration = checked(reinterpret_cast<const XrHapticVibration*>(feedback));
    require(vibration.amplitude >= 0 && vibration.amplitude <= 1, XR_ERROR_VALIDATION_FAILURE, "haptic",
            fmt::format("the amplitude {} must be in 0..1", vibration.amplitude));
    require(vibration.duration > 0 || vibration.duration == XR_MIN_HAPTIC_DURATION, XR_ERROR_VALIDATION_FAILURE,
            "haptic", fmt::format("the duration {} must be positive or XR_MIN_HAPTIC_DURATION", vibration.duration));
    require(vibration.frequency >= 0, XR_ERROR_VALIDATION_FAILURE, "haptic", "the frequency must not be negative");
    if (session.state != XR_SESSION_STATE_FOCUSED) return XR_SESSION_NOT_FOCUSED;
    for (const Source& source : sources)
        runtime().report.haptics.push_back(
            {runtime().progress.frame(), source.input, vibration.amplitude, vibration.duration});
    return XR_SUCCESS;
}

XrResult stop_haptic(XrSession handle, const XrHapticActionInfo* haptic_info) {
    const Session& session = object<Session>(handle);
    haptic_sources(session, checked(haptic_info));
    return session.state == XR_SESSION_STATE_FOCUSED ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

}  // namespace

std::vector<EntryPoint> input_entries() {
    return {NEUVV_XR_ENTRY(xrSyncActions, sync_actions),      NEUVV_XR_ENTRY(xrGetActionStateBoolean, get_boolean),
            NEUVV_XR_ENTRY(xrGetActionStateFloat, get_float), NEUVV_XR_ENTRY(xrGetActionStateVector2f, get_vector),
            NEUVV_XR_ENTRY(xrGetActionStatePose, get_pose),   NEUVV_XR_ENTRY(xrApplyHapticFeedback, apply_haptic),
            NEUVV_XR_ENTRY(xrStopHapticFeedback, stop_haptic)};
}

}  // namespace neuvv::xr_runtime
