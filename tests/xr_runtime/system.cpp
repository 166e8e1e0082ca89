// The only system, a headset with two or four views, and its properties.
#include "call.h"
#include "session.h"

namespace neuvv::xr_runtime {

namespace {

constexpr uint32_t kMaxSwapchainSide = 4096;

XrResult get_system(XrInstance handle, const XrSystemGetInfo* get_info, XrSystemId* system) {
    Instance& instance = instance_of(handle);
    const XrSystemGetInfo& info = checked(get_info);
    check_pointer(system, "systemId");
    const bool is_known =
        info.formFactor == XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY || info.formFactor == XR_FORM_FACTOR_HANDHELD_DISPLAY;
    require(is_known, XR_ERROR_VALIDATION_FAILURE, "enum", "XrSystemGetInfo.formFactor is no XrFormFactor");
    if (info.formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) decline(XR_ERROR_FORM_FACTOR_UNSUPPORTED);
    if (!runtime().script.is_system_available) decline(XR_ERROR_FORM_FACTOR_UNAVAILABLE);
    instance.has_system = true;
    *system = kSystem;
    return XR_SUCCESS;
}

XrResult get_system_properties(XrInstance handle, XrSystemId system, XrSystemProperties* out) {
    check_system(instance_of(handle), system);
    XrSystemProperties& properties = checked(out);
    properties.systemId = system;
    properties.vendorId = 0;
    std::snprintf(properties.systemName, sizeof properties.systemName, "NeuVV scripted headset");
    properties.graphicsProperties = {kMaxSwapchainSide, kMaxSwapchainSide, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
    properties.trackingProperties = {XR_TRUE, XR_TRUE};
    auto* hands = const_cast<XrSystemHandTrackingPropertiesEXT*>(chained<XrSystemHandTrackingPropertiesEXT>(out));
    if (hands) hands->supportsHandTracking = runtime().script.has_hand_joints ? XR_TRUE : XR_FALSE;
    auto* gaze =
        const_cast<XrSystemEyeGazeInteractionPropertiesEXT*>(chained<XrSystemEyeGazeInteractionPropertiesEXT>(out));
    if (gaze) gaze->supportsEyeGazeInteraction = runtime().script.has_gaze ? XR_TRUE : XR_FALSE;
    auto* views =
        const_cast<XrSystemFoveatedRenderingPropertiesVARJO*>(chained<XrSystemFoveatedRenderingPropertiesVARJO>(out));
    if (views) views->supportsFoveatedRendering = runtime().script.has_gaze ? XR_TRUE : XR_FALSE;
    auto* room = const_cast<XrSystemPassthroughPropertiesFB*>(chained<XrSystemPassthroughPropertiesFB>(out));
    if (room) room->supportsPassthrough = runtime().script.has_passthrough ? XR_TRUE : XR_FALSE;
    fill_body_properties(properties);
    for (auto* link = static_cast<XrBaseOutStructure*>(properties.next); link; link = link->next)
        if (link->type == xr::kUserPresenceProperties)
            reinterpret_cast<xr::XrSystemUserPresencePropertiesEXT*>(link)->supportsUserPresence = XR_TRUE;
    return XR_SUCCESS;
}

XrResult enumerate_blend_modes(XrInstance handle, XrSystemId system, XrViewConfigurationType type, uint32_t capacity,
                               uint32_t* count, XrEnvironmentBlendMode* out) {
    check_system(instance_of(handle), system);
    check_view_configuration(type);
    return give_values(capacity, count, out, runtime().script.blend_modes);
}

XrResult enumerate_view_configurations(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count,
                                       XrViewConfigurationType* out) {
    check_system(instance_of(handle), system);
    return give_values(capacity, count, out, offered_view_configurations());
}

XrResult get_view_configuration(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                XrViewConfigurationProperties* out) {
    check_system(instance_of(handle), system);
    check_view_configuration(type);
    XrViewConfigurationProperties& properties = checked(out);
    properties.viewConfigurationType = type;
    properties.fovMutable = XR_FALSE;
    return XR_SUCCESS;
}

XrResult enumerate_views(XrInstance handle, XrSystemId system, XrViewConfigurationType type, uint32_t capacity,
                         uint32_t* count, XrViewConfigurationView* out) {
    check_system(instance_of(handle), system);
    check_view_configuration(type);
    const Script& script = runtime().script;
    return give_structs(capacity, count, out, view_count(type), [&](XrViewConfigurationView& view, size_t i) {
        const bool is_wide = i < 2;
        const auto* foveated = chained<XrFoveatedViewConfigurationViewVARJO>(&view);
        const uint32_t divisor = is_wide && foveated && foveated->foveatedRenderingActive ? 2 : 1;
        const uint32_t width = is_wide ? script.width : script.narrow->width,
                       height = is_wide ? script.height : script.narrow->height;
        view.recommendedImageRectWidth = width / divisor;
        view.maxImageRectWidth = 2 * width;
        view.recommendedImageRectHeight = height / divisor;
        view.maxImageRectHeight = 2 * height;
        view.recommendedSwapchainSampleCount = view.maxSwapchainSampleCount = 1;
    });
}

XrResult enumerate_rates(XrSession handle, uint32_t capacity, uint32_t* count, float* out) {
    object<Session>(handle);
    return give_values(capacity, count, out, runtime().script.rates_hz);
}

XrResult get_rate(XrSession handle, float* out) {
    object<Session>(handle);
    check_pointer(out, "displayRefreshRate");
    *out = runtime().progress.refresh_hz;
    return XR_SUCCESS;
}

XrResult request_rate(XrSession handle, float hz) {
    Session& session = object<Session>(handle);
    if (hz == 0) return XR_SUCCESS;  // the application leaves the rate to the system
    const auto& rates = runtime().script.rates_hz;
    require(std::find(rates.begin(), rates.end(), hz) != rates.end(), XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB,
            "refresh-rate", fmt::format("{} Hz is none of the enumerated display refresh rates", hz));
    set_refresh_rate(session, hz);
    return XR_SUCCESS;
}

}  // namespace

std::vector<EntryPoint> system_entries() {
    constexpr const char* kRefresh = XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY(xrGetSystem, get_system),
            NEUVV_XR_ENTRY(xrGetSystemProperties, get_system_properties),
            NEUVV_XR_ENTRY(xrEnumerateEnvironmentBlendModes, enumerate_blend_modes),
            NEUVV_XR_ENTRY(xrEnumerateViewConfigurations, enumerate_view_configurations),
            NEUVV_XR_ENTRY(xrGetViewConfigurationProperties, get_view_configuration),
            NEUVV_XR_ENTRY(xrEnumerateViewConfigurationViews, enumerate_views),
            NEUVV_XR_ENTRY_OF(kRefresh, nullptr, xrEnumerateDisplayRefreshRatesFB, enumerate_rates),
            NEUVV_XR_ENTRY_OF(kRefresh, nullptr, xrGetDisplayRefreshRateFB, get_rate),
            NEUVV_XR_ENTRY_OF(kRefresh, nullptr, xrRequestDisplayRefreshRateFB, request_rate)};
}

}  // namespace neuvv::xr_runtime
