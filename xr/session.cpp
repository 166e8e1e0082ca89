#include "xr/session.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "xr/newer_types.h"

namespace neuvv::xr {

namespace {

XrOwnedSpace reference_space(XrSession session, XrReferenceSpaceType type, const Pose& origin = {}) {
    XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
    info.referenceSpaceType = type;
    info.poseInReferenceSpace = xr_pose(origin);
    XrOwnedSpace space;
    check(xrCreateReferenceSpace(session, &info, space.out()), "xrCreateReferenceSpace", "session");
    return space;
}

bool is_known(XrFlags64 flags) {
    constexpr XrFlags64 kBoth = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
    return (flags & kBoth) == kBoth;
}

}  // namespace

Pose pose_of(const XrPosef& pose) {
    const auto& [q, p] = pose;
    return {{p.x, p.y, p.z}, glm::normalize(glm::dquat(q.w, q.x, q.y, q.z))};
}

XrPosef xr_pose(const Pose& pose) {
    const glm::quat q(glm::normalize(pose.rotation));
    const glm::vec3 p(pose.position);
    return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}

bool spans_image(const XrFovf& fov) {
    constexpr float kMax_rad = 1.56f;
    const bool sound = std::abs(fov.angleLeft) < kMax_rad && std::abs(fov.angleRight) < kMax_rad &&
                       std::abs(fov.angleUp) < kMax_rad && std::abs(fov.angleDown) < kMax_rad;  // false for NaN
    return sound && fov.angleRight - fov.angleLeft > 1e-3f && fov.angleUp - fov.angleDown > 1e-3f;
}

Session::Session(const Runtime& runtime, const gpu::Device& device) : runtime_(runtime), device_(device) {
    XrGraphicsBindingVulkanKHR graphics{XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR};
    graphics.instance = device.instance();
    graphics.physicalDevice = device.physical();
    graphics.device = device.handle();
    graphics.queueFamilyIndex = device.queue_family();
    graphics.queueIndex = 0;
    const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &graphics, 0, runtime.system()};
    const std::lock_guard lock(device.queue_mutex());
    check(xrCreateSession(runtime.instance(), &info, session_.out()), "xrCreateSession", runtime.headset());
    create_spaces();
}

void Session::create_spaces() {
    spaces_ = enumerate("xrEnumerateReferenceSpaces", runtime_.headset(), XrReferenceSpaceType{},
                        [&](uint32_t capacity, uint32_t* count, XrReferenceSpaceType* all) {
                            return xrEnumerateReferenceSpaces(handle(), capacity, count, all);
                        });
    centred_type_ = offers(kLocalFloorSpace) ? kLocalFloorSpace : XR_REFERENCE_SPACE_TYPE_LOCAL;
    tracking_type_ = offers(XR_REFERENCE_SPACE_TYPE_STAGE) ? XR_REFERENCE_SPACE_TYPE_STAGE : centred_type_;
    knows_floor_ = tracking_type_ != XR_REFERENCE_SPACE_TYPE_LOCAL;
    if (!knows_floor_) reference_from_tracking_.position.y = -kEyeHeight_m;
    tracking_ = reference_space(handle(), tracking_type_, reference_from_tracking_);
    head_ = reference_space(handle(), XR_REFERENCE_SPACE_TYPE_VIEW);
    constexpr XrReferenceSpaceType kGaze = XR_REFERENCE_SPACE_TYPE_COMBINED_EYE_VARJO;
    if (runtime_.narrow_views_follow_gaze() && offers(kGaze)) gaze_ = reference_space(handle(), kGaze);
}

bool Session::offers(XrReferenceSpaceType space) const {
    return std::find(spaces_.begin(), spaces_.end(), space) != spaces_.end();
}

const char* Session::floor_title() const {
    if (tracking_type_ == XR_REFERENCE_SPACE_TYPE_STAGE) return "the runtime knows it (STAGE space)";
    if (knows_floor_) return "the runtime knows it (LOCAL_FLOOR space)";
    return "unknown (LOCAL space): eyes are taken to be 1.6 m above it";
}

// LOCAL and LOCAL_FLOOR move where the user asks for it. STAGE moves where its area or its floor is found anew, and
// then the runtime knows by how much; a runtime that recentres STAGE as well does not say. Where STAGE moves by a known
// pose, a LOCAL that moves, too, may only have gone along with it, but LOCAL_FLOOR was centred.
void Session::note_change(const XrEventDataReferenceSpaceChangePending& event,
                          std::optional<TrackingChange>& change) const {
    const bool floor_is_centred = centred_type_ == kLocalFloorSpace;
    if (event.referenceSpaceType == tracking_type_) {
        const bool found_anew = tracking_type_ == XR_REFERENCE_SPACE_TYPE_STAGE && event.poseValid;
        const bool asked_before = change && change->by_user && floor_is_centred;
        const std::optional<Pose> before = change ? change->old_from_new : Pose();
        change = TrackingChange{event.changeTime, {}, !found_anew || asked_before};
        if (event.poseValid && before)
            change->old_from_new = *before * (inverse(reference_from_tracking_) * pose_of(event.poseInPreviousSpace) *
                                              reference_from_tracking_);
    } else if (event.referenceSpaceType == centred_type_ || event.referenceSpaceType == XR_REFERENCE_SPACE_TYPE_LOCAL) {
        if (!change)
            change = TrackingChange{event.changeTime, Pose(), true};
        else
            change->by_user |= floor_is_centred;
    }
}

void Session::begin_session() {
    const XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr, runtime_.view_configuration()};
    check(xrBeginSession(handle(), &info), "xrBeginSession", runtime_.headset());
    running_ = true;
}

void Session::end_session() {
    running_ = false;
    check(xrEndSession(handle()), "xrEndSession", runtime_.headset());
}

void Session::on_state_changed(const XrEventDataSessionStateChanged& event) {
    if (event.session != handle()) return;
    state_ = event.state;
    switch (state_) {
        case XR_SESSION_STATE_READY:
            return begin_session();
        case XR_SESSION_STATE_STOPPING:
            return end_session();
        case XR_SESSION_STATE_EXITING:
            ended_ = true;
            return;
        case XR_SESSION_STATE_LOSS_PENDING:
            running_ = false;
            lost_ = true;
            return;
        default:
            return;
    }
}

SessionStatus Session::poll(SessionEvents& events) {
    const bool had_focus = state_ == XR_SESSION_STATE_FOCUSED;
    for (XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
         check(xrPollEvent(runtime_.instance(), &event), "xrPollEvent", runtime_.name()) == XR_SUCCESS;
         event = {XR_TYPE_EVENT_DATA_BUFFER}) {
        const auto as = [&]<typename T>(T) { return reinterpret_cast<const T&>(event); };
        switch (static_cast<int64_t>(event.type)) {  // some types are newer than the header
            case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED:
                on_state_changed(as(XrEventDataSessionStateChanged{}));
                break;
            case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
                throw XrFailure(XR_ERROR_INSTANCE_LOST, "xrPollEvent", runtime_.name());
            case XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED:
                events.controllers_changed = true;
                break;
            case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING: {
                const auto& pending = as(XrEventDataReferenceSpaceChangePending{});
                if (pending.session == handle()) note_change(pending, events.tracking_change);
                break;
            }
            case XR_TYPE_EVENT_DATA_PASSTHROUGH_STATE_CHANGED_FB: {
                constexpr XrPassthroughStateChangedFlagsFB kLost =
                    XR_PASSTHROUGH_STATE_CHANGED_REINIT_REQUIRED_BIT_FB |
                    XR_PASSTHROUGH_STATE_CHANGED_NON_RECOVERABLE_ERROR_BIT_FB;
                events.passthrough_lost |= (as(XrEventDataPassthroughStateChangedFB{}).flags & kLost) != 0;
                break;
            }
            case kUserPresenceChanged:
                if (const auto& change = as(XrEventDataUserPresenceChangedEXT{}); change.session == handle())
                    events.is_worn = change.isUserPresent == XR_TRUE;
                break;
            case XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR:
                if (const uint32_t view = as(XrEventDataVisibilityMaskChangedKHR{}).viewIndex; view < kMaxViews)
                    events.mask_changed[view] = true;
                break;
            default:
                break;  // such as refresh rates, which show in times; and unused extensions
        }
    }
    // A session that ends loses the input, too, but nobody will see that the stage pauses.
    const bool has_focus = state_ == XR_SESSION_STATE_FOCUSED;
    if (running_ && has_focus != had_focus) events.has_focus = has_focus;
    if (lost_) return SessionStatus::kLost;
    if (ended_) return SessionStatus::kEnded;
    return running_ ? SessionStatus::kRunning : SessionStatus::kIdle;
}

void Session::request_exit() {
    if (running_)
        check(xrRequestExitSession(handle()), "xrRequestExitSession", runtime_.headset());
    else
        ended_ = true;
}

FrameTime Session::wait_frame() {
    XrFrameState state{XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(handle(), nullptr, &state), "xrWaitFrame", runtime_.headset());
    return {state.predictedDisplayTime, state.predictedDisplayPeriod, state.shouldRender == XR_TRUE};
}

void Session::begin_frame() {
    const std::lock_guard lock(device_.queue_mutex());
    check(xrBeginFrame(handle(), nullptr), "xrBeginFrame", runtime_.headset());
}

void Session::end_frame(const FrameTime& time, XrEnvironmentBlendMode blend,
                        std::span<const XrCompositionLayerBaseHeader* const> layers) {
    XrFrameEndInfo info{XR_TYPE_FRAME_END_INFO};
    info.displayTime = time.display;
    info.environmentBlendMode = blend;
    info.layerCount = static_cast<uint32_t>(layers.size());
    info.layers = layers.data();
    const std::lock_guard lock(device_.queue_mutex());
    check(xrEndFrame(handle(), &info), "xrEndFrame", runtime_.headset());
}

bool Session::is_gaze_tracked(XrTime time) const {
    if (gaze_.get() == XR_NULL_HANDLE) return false;
    XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
    check(xrLocateSpace(gaze_.get(), head_space(), time, &location), "xrLocateSpace", runtime_.headset());
    return (location.locationFlags & XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT) != 0;
}

std::optional<EyeViews> Session::locate_eyes(XrTime time) {
    const bool follows_gaze = is_gaze_tracked(time);
    const XrViewLocateFoveatedRenderingVARJO foveated{XR_TYPE_VIEW_LOCATE_FOVEATED_RENDERING_VARJO, nullptr, XR_TRUE};
    const XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, follows_gaze ? &foveated : nullptr,
                                runtime_.view_configuration(), time, tracking_space()};
    XrViewState state{XR_TYPE_VIEW_STATE};
    std::vector<XrView> views(runtime_.view_count(), {XR_TYPE_VIEW});
    uint32_t count = 0;
    check(xrLocateViews(handle(), &info, &state, runtime_.view_count(), &count, views.data()), "xrLocateViews",
          runtime_.headset());
    const bool all_span =
        std::all_of(views.begin(), views.end(), [](const XrView& view) { return spans_image(view.fov); });
    if (!is_known(state.viewStateFlags) || !all_span) return last_eyes_;
    last_eyes_ = EyeViews{{}, follows_gaze};
    for (const XrView& view : views) last_eyes_->views.push_back({pose_of(view.pose), view.fov});
    return last_eyes_;
}

std::optional<Pose> Session::locate(XrSpace space, XrTime time) const {
    XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
    check(xrLocateSpace(space, tracking_space(), time, &location), "xrLocateSpace", runtime_.headset());
    if (!is_known(location.locationFlags)) return std::nullopt;
    return pose_of(location.pose);
}

std::optional<glm::dvec2> Session::play_area() const {
    if (tracking_type_ != XR_REFERENCE_SPACE_TYPE_STAGE) return std::nullopt;  // the runtime has no STAGE
    XrExtent2Df sides{};
    const XrResult result = xrGetReferenceSpaceBoundsRect(handle(), XR_REFERENCE_SPACE_TYPE_STAGE, &sides);
    const bool is_known = succeeded(result, "xrGetReferenceSpaceBoundsRect", runtime_.headset()) &&
                          result != XR_SPACE_BOUNDS_UNAVAILABLE && sides.width > 0 && sides.height > 0;
    return is_known ? std::optional(glm::dvec2(sides.width, sides.height)) : std::nullopt;
}

std::vector<float> Session::refresh_rates() const {
    if (!runtime_.has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return {};
    constexpr const char* kCall = "xrEnumerateDisplayRefreshRatesFB";
    const auto get = runtime_.function<PFN_xrEnumerateDisplayRefreshRatesFB>(kCall);
    return enumerate(kCall, runtime_.headset(), 0.0f, [&](uint32_t capacity, uint32_t* count, float* all) {
        return get(handle(), capacity, count, all);
    });
}

void Session::request_refresh_rate(float hz) {
    constexpr const char* kCall = "xrRequestDisplayRefreshRateFB";
    check(runtime_.function<PFN_xrRequestDisplayRefreshRateFB>(kCall)(handle(), hz), kCall, runtime_.headset());
}

}  // namespace neuvv::xr
