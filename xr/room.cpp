#include "xr/room.h"

#include <algorithm>

namespace neuvv::xr {

namespace {

bool offers(const Runtime& runtime, XrEnvironmentBlendMode mode) {
    const auto& modes = runtime.blend_modes();
    return std::find(modes.begin(), modes.end(), mode) != modes.end();
}

}  // namespace

RoomView best_room_view(const Runtime& runtime) {
    if (offers(runtime, XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND)) return RoomView::kAlphaBlend;
    if (runtime.supports(XR_FB_PASSTHROUGH_EXTENSION_NAME)) return RoomView::kPassthrough;
    if (offers(runtime, XR_ENVIRONMENT_BLEND_MODE_ADDITIVE)) return RoomView::kAdditive;
    return RoomView::kNone;
}

const char* title_of(RoomView view) {
    switch (view) {
        case RoomView::kAlphaBlend:
            return "the blend mode \"alpha blend\"";
        case RoomView::kPassthrough:
            return XR_FB_PASSTHROUGH_EXTENSION_NAME;
        case RoomView::kAdditive:
            return "a display that adds light";
        case RoomView::kNone:
            break;
    }
    return "not possible";
}

Room::Room(const Session& session) : session_(session), view_(best_room_view(session.runtime())) {}

void Room::show(bool wanted) {
    const bool can_hide = offers(session_.runtime(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE);
    const bool shows = view_ != RoomView::kNone && (wanted || !can_hide);
    if (shows == is_shown_) return;
    if (!shows) return hide();
    if (view_ == RoomView::kPassthrough && !start_passthrough()) {
        hide();
        view_ = RoomView::kNone;
        return;
    }
    is_shown_ = true;
}

bool Room::start_passthrough() {
    const Runtime& runtime = session_.runtime();
    // The destructor calls these, and a lost runtime might not answer then.
    destroy_passthrough_ = runtime.function<PFN_xrDestroyPassthroughFB>("xrDestroyPassthroughFB");
    destroy_images_ = runtime.function<PFN_xrDestroyPassthroughLayerFB>("xrDestroyPassthroughLayerFB");
    const XrPassthroughCreateInfoFB info{XR_TYPE_PASSTHROUGH_CREATE_INFO_FB, nullptr,
                                         XR_PASSTHROUGH_IS_RUNNING_AT_CREATION_BIT_FB};
    const auto create = runtime.function<PFN_xrCreatePassthroughFB>("xrCreatePassthroughFB");
    if (!succeeded(create(session_.handle(), &info, &passthrough_), "xrCreatePassthroughFB", runtime.headset()))
        return false;
    const XrPassthroughLayerCreateInfoFB images{XR_TYPE_PASSTHROUGH_LAYER_CREATE_INFO_FB, nullptr, passthrough_,
                                                XR_PASSTHROUGH_IS_RUNNING_AT_CREATION_BIT_FB,
                                                XR_PASSTHROUGH_LAYER_PURPOSE_RECONSTRUCTION_FB};
    const auto create_layer = runtime.function<PFN_xrCreatePassthroughLayerFB>("xrCreatePassthroughLayerFB");
    const XrResult result = create_layer(session_.handle(), &images, &images_);
    layer_.layerHandle = images_;
    return succeeded(result, "xrCreatePassthroughLayerFB", runtime.headset());
}

// Destroying the passthrough, rather than pausing it, lets the runtime switch the cameras off.
void Room::hide() {
    is_shown_ = false;
    if (images_ != XR_NULL_HANDLE) destroy_images_(images_);
    if (passthrough_ != XR_NULL_HANDLE) destroy_passthrough_(passthrough_);
    images_ = XR_NULL_HANDLE;
    passthrough_ = XR_NULL_HANDLE;
}

XrEnvironmentBlendMode Room::blend_mode() const {
    if (is_shown_ && view_ == RoomView::kAlphaBlend) return XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND;
    if (is_shown_ && view_ == RoomView::kAdditive) return XR_ENVIRONMENT_BLEND_MODE_ADDITIVE;
    const bool has_opaque = offers(session_.runtime(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE);
    return has_opaque ? XR_ENVIRONMENT_BLEND_MODE_OPAQUE : session_.runtime().blend_modes()[0];
}

const XrCompositionLayerBaseHeader* Room::layer() const {
    return images_ == XR_NULL_HANDLE ? nullptr : reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer_);
}

}  // namespace neuvv::xr
