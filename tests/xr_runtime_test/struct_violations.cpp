// Violations of what every function requires of its parameters: types, chains, pointers, handles, paths, counts.
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

XrResult get_properties(Application& app, void* chain) {
    app.make_instance();
    XrSystemProperties properties = {XR_TYPE_SYSTEM_PROPERTIES, chain};
    return xrGetSystemProperties(app.instance, app.system, &properties);
}

XrResult chain_twice(Application& app) {
    app.extensions.push_back(XR_EXT_HAND_TRACKING_EXTENSION_NAME);
    XrSystemHandTrackingPropertiesEXT last = {XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT};
    XrSystemHandTrackingPropertiesEXT first = {XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT, &last};
    return get_properties(app, &first);
}

XrResult chain_stranger(Application& app) {
    XrFrameState stranger = {XR_TYPE_FRAME_STATE};
    return get_properties(app, &stranger);
}

XrResult chain_without_extension(Application& app) {
    XrSystemHandTrackingPropertiesEXT hands = {XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT};
    return get_properties(app, &hands);
}

XrResult wrong_type(Application& app) {
    app.make_instance();
    const XrSystemGetInfo info = {XR_TYPE_SYSTEM_PROPERTIES, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    return xrGetSystem(app.instance, &info, &app.system);
}

XrResult wrong_type_of_output(Application& app) {
    app.make_instance();
    XrSystemProperties properties = {};
    return xrGetSystemProperties(app.instance, app.system, &properties);
}

XrResult wrong_type_in_array(Application& app) {
    app.make_instance();
    XrViewConfigurationView views[2] = {{XR_TYPE_VIEW_CONFIGURATION_VIEW}, {XR_TYPE_VIEW}};
    uint32_t count = 0;
    return xrEnumerateViewConfigurationViews(app.instance, app.system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 2,
                                             &count, views);
}

XrResult no_struct(Application& app) {
    app.make_session();
    return xrBeginSession(app.session, nullptr);
}

XrResult no_output(Application& app) {
    app.make_instance();
    const XrSystemGetInfo info = {XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    return xrGetSystem(app.instance, &info, nullptr);
}

XrResult enumerate_formats(Application& app, uint32_t capacity, bool has_count, bool has_values) {
    app.make_session();
    uint32_t count = 0;
    std::vector<int64_t> formats(capacity);
    return xrEnumerateSwapchainFormats(app.session, capacity, has_count ? &count : nullptr,
                                       has_values ? formats.data() : nullptr);
}

XrResult short_text(Application& app) {
    app.make_instance();
    char text[4];
    uint32_t count = 0;
    return xrPathToString(app.instance, app.path("/user/head"), sizeof text, &count, text);
}

// --- Handles ---

template <typename To, typename From>
To handle_as(From handle) {
    return reinterpret_cast<To>(handle);
}

XrResult use_destroyed(Application& app) {
    app.make_session();
    check(xrDestroySpace(app.space), "xrDestroySpace");
    return xrDestroySpace(app.space);
}

XrResult use_orphan(Application& app) {
    app.make_session();
    check(xrDestroySession(app.session), "xrDestroySession");
    app.session = XR_NULL_HANDLE;
    return xrDestroySwapchain(app.colour);
}

XrResult use_another_kind(Application& app) {
    app.make_session();
    return xrDestroySwapchain(handle_as<XrSwapchain>(app.space));
}

XrResult use_null(Application& app) {
    app.make_session();
    return xrRequestExitSession(XR_NULL_HANDLE);
}

XrResult use_another_instance(Application& app) {
    app.make_instance();
    XrInstanceProperties properties = {XR_TYPE_INSTANCE_PROPERTIES};
    return xrGetInstanceProperties(handle_as<XrInstance>(uint64_t{77}), &properties);
}

XrResult name_nothing(Application& app) {
    app.extensions.push_back(XR_EXT_DEBUG_UTILS_EXTENSION_NAME);
    app.make_instance();
    const XrDebugUtilsObjectNameInfoEXT info = {XR_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr,
                                                XR_OBJECT_TYPE_SESSION, 77, "nothing"};
    return app.function<PFN_xrSetDebugUtilsObjectNameEXT>("xrSetDebugUtilsObjectNameEXT")(app.instance, &info);
}

XrResult listen_to_nothing(Application& app) {
    app.extensions.push_back(XR_EXT_DEBUG_UTILS_EXTENSION_NAME);
    app.make_instance();
    const XrDebugUtilsMessengerCreateInfoEXT info = {XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    XrDebugUtilsMessengerEXT messenger = XR_NULL_HANDLE;
    return app.function<PFN_xrCreateDebugUtilsMessengerEXT>("xrCreateDebugUtilsMessengerEXT")(app.instance, &info,
                                                                                              &messenger);
}

// --- Paths ---

XrResult make_path(Application& app, const char* text) {
    app.make_instance();
    XrPath path = XR_NULL_PATH;
    return xrStringToPath(app.instance, text, &path);
}

XrResult read_unknown_path(Application& app) {
    app.make_instance();
    uint32_t count = 0;
    return xrPathToString(app.instance, app.path("/user/head") + 1, 0, &count, nullptr);
}

XrResult use_path_of_another_instance(Application& app) {
    app.make_instance();
    const XrPath old = app.path("/user/head");
    check(xrDestroyInstance(app.instance), "xrDestroyInstance");
    app.instance = XR_NULL_HANDLE;
    app.make_instance();
    uint32_t count = 0;
    return xrPathToString(app.instance, old, 0, &count, nullptr);
}

}  // namespace

std::vector<Violation> struct_violations() {
    using App = Application;
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE;
    const Severity warning = Severity::kWarning;
    return {
        {"WrongType", "type", "xrGetSystem", invalid, wrong_type},
        {"WrongTypeOfOutput", "type", "xrGetSystemProperties", invalid, wrong_type_of_output},
        {"WrongTypeInArray", "type", "xrEnumerateViewConfigurationViews", invalid, wrong_type_in_array},
        {"ChainedTwice", "next-chain", "xrGetSystemProperties", invalid, chain_twice},
        {"ChainedStranger", "next-chain", "xrGetSystemProperties", XR_SUCCESS, chain_stranger, warning},
        {"ChainedWithoutExtension", "extension", "xrGetSystemProperties", XR_SUCCESS, chain_without_extension},
        {"NoStruct", "null", "xrBeginSession", invalid, no_struct},
        {"NoOutput", "null", "xrGetSystem", invalid, no_output},
        {"NoCount", "null", "xrEnumerateSwapchainFormats", invalid,
         [](App& app) { return enumerate_formats(app, 0, false, false); }},
        {"NoArray", "null", "xrEnumerateSwapchainFormats", invalid,
         [](App& app) { return enumerate_formats(app, 9, true, false); }},
        {"ShortArray", "two-call", "xrEnumerateSwapchainFormats", XR_ERROR_SIZE_INSUFFICIENT,
         [](App& app) { return enumerate_formats(app, 1, true, true); }, warning},
        {"ShortText", "two-call", "xrPathToString", XR_ERROR_SIZE_INSUFFICIENT, short_text, warning},
        {"DestroyedHandle", "handle", "xrDestroySpace", XR_ERROR_HANDLE_INVALID, use_destroyed},
        {"HandleOfDestroyedParent", "handle", "xrDestroySwapchain", XR_ERROR_HANDLE_INVALID, use_orphan},
        {"HandleOfAnotherKind", "handle", "xrDestroySwapchain", XR_ERROR_HANDLE_INVALID, use_another_kind},
        {"NullHandle", "handle", "xrRequestExitSession", XR_ERROR_HANDLE_INVALID, use_null},
        {"UnknownHandle", "handle", "xrGetInstanceProperties", XR_ERROR_HANDLE_INVALID, use_another_instance},
        {"NameOfNothing", "handle", "xrSetDebugUtilsObjectNameEXT", XR_ERROR_HANDLE_INVALID, name_nothing},
        {"MessengerToNobody", "debug", "xrCreateDebugUtilsMessengerEXT", invalid, listen_to_nothing},
        {"PathWithoutSlash", "path", "xrStringToPath", XR_ERROR_PATH_FORMAT_INVALID,
         [](App& app) { return make_path(app, "user/head"); }},
        {"PathWithCapitals", "path", "xrStringToPath", XR_ERROR_PATH_FORMAT_INVALID,
         [](App& app) { return make_path(app, "/user/Head"); }},
        {"PathOfDots", "path", "xrStringToPath", XR_ERROR_PATH_FORMAT_INVALID,
         [](App& app) { return make_path(app, "/user/.."); }},
        {"PathWithEmptyPart", "path", "xrStringToPath", XR_ERROR_PATH_FORMAT_INVALID,
         [](App& app) { return make_path(app, "/user//head"); }},
        {"UnknownPath", "path", "xrPathToString", XR_ERROR_PATH_INVALID, read_unknown_path},
        {"PathOfAnotherInstance", "path", "xrPathToString", XR_ERROR_PATH_INVALID, use_path_of_another_instance},
    };
}

}  // namespace neuvv::test
