// XR_EXT_debug_utils: its functions are checked and have no effect, as findings go to the report.
#include "call.h"

namespace neuvv::xr_runtime {

namespace {

XrResult set_object_name(XrInstance handle, const XrDebugUtilsObjectNameInfoEXT* info) {
    instance_of(handle);
    const uint64_t named = checked(info).objectHandle;
    require(runtime().objects.contains(named), XR_ERROR_HANDLE_INVALID, "handle",
            fmt::format("no object has the handle {:#x}", named));
    return XR_SUCCESS;
}

XrResult create_messenger(XrInstance handle, const XrDebugUtilsMessengerCreateInfoEXT* create_info,
                          XrDebugUtilsMessengerEXT* out) {
    instance_of(handle);
    const XrDebugUtilsMessengerCreateInfoEXT& info = checked(create_info);
    check_pointer(out, "messenger");
    require(info.messageSeverities && info.messageTypes && info.userCallback, XR_ERROR_VALIDATION_FAILURE, "debug",
            "a messenger needs severities, types and a callback");
    *out = make_object<Messenger>()->handle;
    return XR_SUCCESS;
}

XrResult destroy_messenger(XrDebugUtilsMessengerEXT handle) {
    shared<Messenger>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult submit_message(XrInstance handle, XrDebugUtilsMessageSeverityFlagsEXT, XrDebugUtilsMessageTypeFlagsEXT,
                        const XrDebugUtilsMessengerCallbackDataEXT* data) {
    instance_of(handle);
    checked(data);
    return XR_SUCCESS;
}

XrResult take_label(XrSession handle, const XrDebugUtilsLabelEXT* label) {
    object<Session>(handle);
    checked(label);
    return XR_SUCCESS;
}

XrResult end_label(XrSession handle) {
    object<Session>(handle);
    return XR_SUCCESS;
}

}  // namespace

std::vector<EntryPoint> debug_entries() {
    constexpr const char* kDebug = XR_EXT_DEBUG_UTILS_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrSetDebugUtilsObjectNameEXT, set_object_name),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrCreateDebugUtilsMessengerEXT, create_messenger),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrDestroyDebugUtilsMessengerEXT, destroy_messenger),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrSubmitDebugUtilsMessageEXT, submit_message),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrSessionBeginDebugUtilsLabelRegionEXT, take_label),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrSessionEndDebugUtilsLabelRegionEXT, end_label),
            NEUVV_XR_ENTRY_OF(kDebug, nullptr, xrSessionInsertDebugUtilsLabelEXT, take_label)};
}

}  // namespace neuvv::xr_runtime
