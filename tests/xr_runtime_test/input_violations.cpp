// Violations where a session reads its actions, and in haptics.
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

// An application with the input focus, after xrSyncActions.
void make_synced(Application& app) {
    app.attach_actions();
    app.make_focused();
    check(app.sync_actions(), "xrSyncActions");
}

XrResult sync_before_attaching(Application& app) {
    app.make_session();
    app.make_actions();
    return app.sync_actions();
}

XrResult sync_with(Application& app, const XrActiveActionSet& active) {
    const XrActionsSyncInfo info = {XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
    return xrSyncActions(app.session, &info);
}

XrResult sync_another_set(Application& app) {
    app.attach_actions();
    const XrActionSetCreateInfo info = {XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "more", "More", 0};
    XrActionSet set = XR_NULL_HANDLE;
    check(xrCreateActionSet(app.instance, &info, &set), "xrCreateActionSet");
    return sync_with(app, {set, XR_NULL_PATH});
}

XrResult sync_for(Application& app, const char* path) {
    app.attach_actions();
    return sync_with(app, {app.action_set, app.path(path)});
}

// --- States ---

XrResult read_button(Application& app, XrAction action, XrPath path = XR_NULL_PATH) {
    const XrActionStateGetInfo info = {XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, path};
    XrActionStateBoolean state = {XR_TYPE_ACTION_STATE_BOOLEAN};
    return xrGetActionStateBoolean(app.session, &info, &state);
}

XrResult read_before_attaching(Application& app) {
    app.make_session();
    app.make_actions();
    return read_button(app, app.press);
}

XrResult read_before_syncing(Application& app) {
    app.attach_actions();
    return read_button(app, app.press);
}

XrResult read_pose_as_button(Application& app) {
    make_synced(app);
    return read_button(app, app.grip);
}

XrResult read_for(Application& app, const char* path) {
    make_synced(app);
    return read_button(app, app.press, app.path(path));
}

XrResult read_for_unknown_path(Application& app) {
    make_synced(app);
    return read_button(app, app.press, 77);
}

XrResult read_destroyed(Application& app) {
    make_synced(app);
    check(xrDestroyAction(app.press), "xrDestroyAction");
    return read_button(app, app.press);
}

// --- Spaces and names ---

XrResult make_space(Application& app, XrAction action, XrPath path, XrQuaternionf orientation = {0, 0, 0, 1}) {
    const XrActionSpaceCreateInfo info = {
        XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action, path, {orientation, {0, 0, 0}}};
    XrSpace space = XR_NULL_HANDLE;
    return xrCreateActionSpace(app.session, &info, &space);
}

XrResult space_of_button(Application& app) {
    app.attach_actions();
    return make_space(app, app.press, XR_NULL_PATH);
}

XrResult space_of_head(Application& app) {
    app.attach_actions();
    return make_space(app, app.grip, app.path("/user/head"));
}

XrResult crooked_action_space(Application& app) {
    app.attach_actions();
    return make_space(app, app.grip, XR_NULL_PATH, {0, 0, 0, 0});
}

XrResult current_profile(Application& app, const char* path) {
    XrInteractionProfileState state = {XR_TYPE_INTERACTION_PROFILE_STATE};
    return xrGetCurrentInteractionProfile(app.session, app.path(path), &state);
}

XrResult profile_before_attaching(Application& app) {
    app.make_session();
    return current_profile(app, "/user/hand/left");
}

XrResult profile_of_foot(Application& app) {
    app.attach_actions();
    return current_profile(app, "/user/foot");
}

XrResult name_of(Application& app, const char* source, XrInputSourceLocalizedNameFlags parts) {
    app.make_session();
    const XrInputSourceLocalizedNameGetInfo info = {XR_TYPE_INPUT_SOURCE_LOCALIZED_NAME_GET_INFO, nullptr,
                                                    app.path(source), parts};
    uint32_t count = 0;
    return xrGetInputSourceLocalizedName(app.session, &info, 0, &count, nullptr);
}

XrResult name_before_attaching(Application& app) {
    return name_of(app, "/user/hand/right/input/trigger/value", XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT);
}

XrResult name_without_parts(Application& app) {
    app.attach_actions();
    return name_of(app, "/user/hand/right/input/trigger/value", 0);
}

XrResult name_of_foot(Application& app) {
    app.attach_actions();
    return name_of(app, "/user/foot", XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT);
}

XrResult sources_before_attaching(Application& app) {
    app.make_session();
    app.make_actions();
    const XrBoundSourcesForActionEnumerateInfo info = {XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO, nullptr,
                                                       app.press};
    uint32_t count = 0;
    return xrEnumerateBoundSourcesForAction(app.session, &info, 0, &count, nullptr);
}

// --- Haptics ---

XrResult vibrate(Application& app, XrAction action, XrDuration duration, float frequency, float amplitude) {
    const XrHapticActionInfo info = {XR_TYPE_HAPTIC_ACTION_INFO, nullptr, action, XR_NULL_PATH};
    const XrHapticVibration vibration = {XR_TYPE_HAPTIC_VIBRATION, nullptr, duration, frequency, amplitude};
    return xrApplyHapticFeedback(app.session, &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration));
}

XrResult vibrate_button(Application& app) {
    make_synced(app);
    return vibrate(app, app.press, XR_MIN_HAPTIC_DURATION, 0, 1);
}

template <XrDuration kDuration, int kFrequency, int kAmplitude>
XrResult vibrate_wrongly(Application& app) {
    make_synced(app);
    return vibrate(app, app.buzz, kDuration, kFrequency, kAmplitude);
}

XrResult vibrate_nothing(Application& app) {
    make_synced(app);
    const XrHapticActionInfo info = {XR_TYPE_HAPTIC_ACTION_INFO, nullptr, app.buzz, XR_NULL_PATH};
    return xrApplyHapticFeedback(app.session, &info, nullptr);
}

}  // namespace

std::vector<Violation> input_violations() {
    using App = Application;
    const char *sync = "xrSyncActions", *read = "xrGetActionStateBoolean", *buzz = "xrApplyHapticFeedback";
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE, unsupported = XR_ERROR_PATH_UNSUPPORTED;
    const XrResult mismatch = XR_ERROR_ACTION_TYPE_MISMATCH, unattached = XR_ERROR_ACTIONSET_NOT_ATTACHED;
    return {
        {"SyncedBeforeAttaching", "action-order", sync, unattached, sync_before_attaching},
        {"AnotherSetSynced", "action-order", sync, unattached, sync_another_set},
        {"SyncedForTheHead", "subaction-path", sync, unsupported, [](App& app) { return sync_for(app, "/user/head"); }},
        {"ReadBeforeAttaching", "action-order", read, unattached, read_before_attaching},
        {"ReadBeforeSyncing", "action-order", read, XR_SUCCESS, read_before_syncing, Severity::kWarning},
        {"PoseReadAsButton", "action-type", read, mismatch, read_pose_as_button},
        {"ReadForTheHead", "subaction-path", read, unsupported, [](App& app) { return read_for(app, "/user/head"); }},
        {"ReadForUnknownPath", "path", read, XR_ERROR_PATH_INVALID, read_for_unknown_path},
        {"DestroyedActionRead", "handle", read, XR_ERROR_HANDLE_INVALID, read_destroyed},
        {"SpaceOfButton", "action-type", "xrCreateActionSpace", mismatch, space_of_button},
        {"SpaceOfHead", "subaction-path", "xrCreateActionSpace", unsupported, space_of_head},
        {"CrookedSpace", "pose", "xrCreateActionSpace", XR_ERROR_POSE_INVALID, crooked_action_space},
        {"ProfileBeforeAttaching", "action-order", "xrGetCurrentInteractionProfile", unattached,
         profile_before_attaching},
        {"ProfileOfFoot", "path", "xrGetCurrentInteractionProfile", unsupported, profile_of_foot},
        {"NameBeforeAttaching", "action-order", "xrGetInputSourceLocalizedName", unattached, name_before_attaching},
        {"NameWithoutParts", "flags", "xrGetInputSourceLocalizedName", invalid, name_without_parts},
        {"NameOfFoot", "path", "xrGetInputSourceLocalizedName", unsupported, name_of_foot},
        {"SourcesBeforeAttaching", "action-order", "xrEnumerateBoundSourcesForAction", unattached,
         sources_before_attaching},
        {"VibratingButton", "action-type", buzz, mismatch, vibrate_button},
        {"TooStrongVibration", "haptic", buzz, invalid, vibrate_wrongly<XR_MIN_HAPTIC_DURATION, 0, 2>},
        {"VibrationOfNegativeLength", "haptic", buzz, invalid, vibrate_wrongly<-5, 0, 1>},
        {"VibrationOfNegativeFrequency", "haptic", buzz, invalid, vibrate_wrongly<XR_MIN_HAPTIC_DURATION, -1, 1>},
        {"NoVibration", "null", buzz, invalid, vibrate_nothing},
    };
}

}  // namespace neuvv::test
