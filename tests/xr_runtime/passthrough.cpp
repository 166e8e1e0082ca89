// XR_FB_passthrough: images of the room as a layer.
#include "call.h"

namespace neuvv::xr_runtime {

namespace {

XrResult create_passthrough(XrSession handle, const XrPassthroughCreateInfoFB* create_info, XrPassthroughFB* out) {
    Session& session = object<Session>(handle);
    const XrPassthroughCreateInfoFB& info = checked(create_info);
    check_pointer(out, "outPassthrough");
    require((info.flags & ~XR_PASSTHROUGH_IS_RUNNING_AT_CREATION_BIT_FB) == 0, XR_ERROR_VALIDATION_FAILURE, "flags",
            "XrPassthroughCreateInfoFB.flags has unknown bits");
    require(runtime().script.has_passthrough, XR_ERROR_FEATURE_UNSUPPORTED, "passthrough",
            "XrSystemPassthroughPropertiesFB.supportsPassthrough is false");
    const auto passthrough = make_object<Passthrough>();
    passthrough->session = &session;
    passthrough->is_running = info.flags != 0;
    *out = passthrough->handle;
    return XR_SUCCESS;
}

XrResult destroy_passthrough(XrPassthroughFB handle) {
    const auto passthrough = shared<Passthrough>(handle);
    for (const auto& layer : all_of<PassthroughLayer>())
        if (layer->passthrough == passthrough) forget(bits(layer->handle));
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult set_running(XrPassthroughFB handle, bool is_running) {
    object<Passthrough>(handle).is_running = is_running;
    return XR_SUCCESS;
}
XrResult start(XrPassthroughFB handle) {
    return set_running(handle, true);
}
XrResult pause(XrPassthroughFB handle) {
    return set_running(handle, false);
}

XrResult create_layer(XrSession handle, const XrPassthroughLayerCreateInfoFB* create_info, XrPassthroughLayerFB* out) {
    Session& session = object<Session>(handle);
    const XrPassthroughLayerCreateInfoFB& info = checked(create_info);
    check_pointer(out, "outLayer");
    require((info.flags & ~XR_PASSTHROUGH_IS_RUNNING_AT_CREATION_BIT_FB) == 0, XR_ERROR_VALIDATION_FAILURE, "flags",
            "XrPassthroughLayerCreateInfoFB.flags has unknown bits");
    require(info.purpose == XR_PASSTHROUGH_LAYER_PURPOSE_RECONSTRUCTION_FB ||
                info.purpose == XR_PASSTHROUGH_LAYER_PURPOSE_PROJECTED_FB,
            XR_ERROR_VALIDATION_FAILURE, "enum", "purpose is no XrPassthroughLayerPurposeFB");
    const auto passthrough = shared<Passthrough>(info.passthrough);
    const auto layer = make_object<PassthroughLayer>();
    layer->session = &session;
    layer->passthrough = passthrough;
    layer->is_running = info.flags != 0;
    *out = layer->handle;
    return XR_SUCCESS;
}

XrResult destroy_layer(XrPassthroughLayerFB handle) {
    shared<PassthroughLayer>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult set_layer_running(XrPassthroughLayerFB handle, bool is_running) {
    object<PassthroughLayer>(handle).is_running = is_running;
    return XR_SUCCESS;
}
XrResult resume_layer(XrPassthroughLayerFB handle) {
    return set_layer_running(handle, true);
}
XrResult pause_layer(XrPassthroughLayerFB handle) {
    return set_layer_running(handle, false);
}

}  // namespace

std::vector<EntryPoint> passthrough_entries() {
    constexpr const char* kPassthrough = XR_FB_PASSTHROUGH_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrCreatePassthroughFB, create_passthrough),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrDestroyPassthroughFB, destroy_passthrough),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrPassthroughStartFB, start),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrPassthroughPauseFB, pause),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrCreatePassthroughLayerFB, create_layer),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrDestroyPassthroughLayerFB, destroy_layer),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrPassthroughLayerResumeFB, resume_layer),
            NEUVV_XR_ENTRY_OF(kPassthrough, nullptr, xrPassthroughLayerPauseFB, pause_layer)};
}

}  // namespace neuvv::xr_runtime
