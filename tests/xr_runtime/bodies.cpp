// Body tracking: XR_FB_body_tracking, XR_META_body_tracking_full_body and XR_BD_body_tracking, with the script's
// joints.
#include "call.h"
#include "pose.h"
#include "spaces.h"

namespace neuvv::xr_runtime {

namespace {

template <typename T>
T& checked_as(T* structure, XrStructureType type, const char* name) {
    require(structure, XR_ERROR_VALIDATION_FAILURE, "null", fmt::format("{} must not be null", name));
    check_chain(type, name, structure);
    return *structure;
}
#define NEUVV_XR_CHECKED(structure, type) checked_as(structure, type, #type)

bool system_tracks(const char* what) {
    return runtime().script.bodies.contains(what);
}

int64_t frame_index(XrTime time) {
    return static_cast<int64_t>(std::floor(frame_at(time) + 1e-6));
}

bool is_body_active(XrTime time) {
    return value_at(runtime().script.body.active, frame_index(time), true);
}

// Fills locations (of either extension) in a space. Returns whether all are tracked.
template <typename Location>
bool fill_joints(Location* out, size_t count, const Space& base, XrTime time) {
    const Located origin = space_in_world(base, time);
    const bool is_active = is_body_active(time);
    bool all_tracked = true;
    for (size_t i = 0; i < count; ++i) {
        const auto track = runtime().script.body.joints.find(static_cast<int>(i));
        BodyJoint joint;
        if (track != runtime().script.body.joints.end()) joint = value_at(track->second, frame_index(time), joint);
        const bool is_valid = is_active && origin.is_valid && joint.flags != 0;
        // What is not valid is garbage on purpose, so that an application that reads it shows.
        out[i] = {is_valid ? joint.flags : 0, {{0, 0, 0, 1}, {77, 77, 77}}};
        if (is_valid) out[i].pose.position = (inverse(origin.pose) * XrPosef{{0, 0, 0, 1}, joint.at}).position;
        all_tracked = all_tracked && out[i].locationFlags == kAllFlags;
    }
    return all_tracked;
}

// --- XR_FB_body_tracking ---

XrResult create_fb(XrSession handle, const XrBodyTrackerCreateInfoFB* create_info, XrBodyTrackerFB* out) {
    Session& session = object<Session>(handle);
    const auto& info = NEUVV_XR_CHECKED(create_info, XR_TYPE_BODY_TRACKER_CREATE_INFO_FB);
    check_pointer(out, "bodyTracker");
    require(system_tracks("fb"), XR_ERROR_FEATURE_UNSUPPORTED, "body-tracking",
            "XrSystemBodyTrackingPropertiesFB.supportsBodyTracking is false");
    const bool is_full = info.bodyJointSet == XR_BODY_JOINT_SET_FULL_BODY_META;
    require(is_full || info.bodyJointSet == XR_BODY_JOINT_SET_DEFAULT_FB, XR_ERROR_VALIDATION_FAILURE, "enum",
            "bodyJointSet is no XrBodyJointSetFB");
    if (is_full) {
        require(session.instance->has(XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME), XR_ERROR_VALIDATION_FAILURE,
                "extension", "the joints of the full body without XR_META_body_tracking_full_body enabled");
        require(system_tracks("full_body"), XR_ERROR_VALIDATION_FAILURE, "body-tracking",
                "XrSystemPropertiesBodyTrackingFullBodyMETA.supportsFullBodyTracking is false");
    }
    const auto tracker = make_object<BodyTrackerFb>();
    tracker->session = &session;
    tracker->joint_count = is_full ? uint32_t{XR_FULL_BODY_JOINT_COUNT_META} : uint32_t{XR_BODY_JOINT_COUNT_FB};
    *out = tracker->handle;
    return XR_SUCCESS;
}

XrResult destroy_fb(XrBodyTrackerFB handle) {
    shared<BodyTrackerFb>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult locate_fb(XrBodyTrackerFB handle, const XrBodyJointsLocateInfoFB* locate_info, XrBodyJointLocationsFB* out) {
    const BodyTrackerFb& tracker = object<BodyTrackerFb>(handle);
    const auto& info = NEUVV_XR_CHECKED(locate_info, XR_TYPE_BODY_JOINTS_LOCATE_INFO_FB);
    auto& locations = NEUVV_XR_CHECKED(out, XR_TYPE_BODY_JOINT_LOCATIONS_FB);
    const Space& base = object<Space>(info.baseSpace);
    check_time(info.time);
    require(locations.jointCount == tracker.joint_count, XR_ERROR_VALIDATION_FAILURE, "joint-count",
            fmt::format("jointCount must be {}, as the tracker's joint set has it", tracker.joint_count));
    check_pointer(locations.jointLocations, "jointLocations");
    fill_joints(locations.jointLocations, locations.jointCount, base, info.time);
    locations.isActive = is_body_active(info.time) ? XR_TRUE : XR_FALSE;
    locations.confidence = value_at(runtime().script.body.confidence, frame_index(info.time), 1.0f);
    locations.skeletonChangedCount = 0;
    locations.time = info.time;
    return XR_SUCCESS;
}

// --- XR_BD_body_tracking ---

XrResult create_bd(XrSession handle, const XrBodyTrackerCreateInfoBD* create_info, XrBodyTrackerBD* out) {
    Session& session = object<Session>(handle);
    const auto& info = NEUVV_XR_CHECKED(create_info, XR_TYPE_BODY_TRACKER_CREATE_INFO_BD);
    check_pointer(out, "bodyTracker");
    require(system_tracks("bd"), XR_ERROR_FEATURE_UNSUPPORTED, "body-tracking",
            "XrSystemBodyTrackingPropertiesBD.supportsBodyTracking is false");
    const bool is_known = info.jointSet == XR_BODY_JOINT_SET_FULL_BODY_JOINTS_BD ||
                          info.jointSet == XR_BODY_JOINT_SET_BODY_WITHOUT_ARM_BD;
    require(is_known, XR_ERROR_VALIDATION_FAILURE, "enum", "jointSet is no XrBodyJointSetBD");
    constexpr uint32_t kWithoutArms = 16;
    const auto tracker = make_object<BodyTrackerBd>();
    tracker->session = &session;
    tracker->joint_count =
        info.jointSet == XR_BODY_JOINT_SET_BODY_WITHOUT_ARM_BD ? kWithoutArms : uint32_t{XR_BODY_JOINT_COUNT_BD};
    *out = tracker->handle;
    return XR_SUCCESS;
}

XrResult destroy_bd(XrBodyTrackerBD handle) {
    shared<BodyTrackerBd>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult locate_bd(XrBodyTrackerBD handle, const XrBodyJointsLocateInfoBD* locate_info, XrBodyJointLocationsBD* out) {
    const BodyTrackerBd& tracker = object<BodyTrackerBd>(handle);
    const auto& info = NEUVV_XR_CHECKED(locate_info, XR_TYPE_BODY_JOINTS_LOCATE_INFO_BD);
    auto& locations = NEUVV_XR_CHECKED(out, XR_TYPE_BODY_JOINT_LOCATIONS_BD);
    const Space& base = object<Space>(info.baseSpace);
    check_time(info.time);
    require(locations.jointLocationCount == tracker.joint_count, XR_ERROR_VALIDATION_FAILURE, "joint-count",
            fmt::format("jointLocationCount must be {}, as the tracker's joint set has it", tracker.joint_count));
    check_pointer(locations.jointLocations, "jointLocations");
    const bool all = fill_joints(locations.jointLocations, locations.jointLocationCount, base, info.time);
    locations.allJointPosesTracked = all ? XR_TRUE : XR_FALSE;
    return XR_SUCCESS;
}

}  // namespace

void fill_body_properties(const XrSystemProperties& properties) {
    for (auto* link = static_cast<XrBaseOutStructure*>(properties.next); link; link = link->next) {
        const auto answer = [&](XrBool32& has, const char* what) { has = system_tracks(what) ? XR_TRUE : XR_FALSE; };
        if (link->type == XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_FB)
            answer(reinterpret_cast<XrSystemBodyTrackingPropertiesFB*>(link)->supportsBodyTracking, "fb");
        if (link->type == XR_TYPE_SYSTEM_PROPERTIES_BODY_TRACKING_FULL_BODY_META)
            answer(reinterpret_cast<XrSystemPropertiesBodyTrackingFullBodyMETA*>(link)->supportsFullBodyTracking,
                   "full_body");
        if (link->type == XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_BD)
            answer(reinterpret_cast<XrSystemBodyTrackingPropertiesBD*>(link)->supportsBodyTracking, "bd");
    }
}

std::vector<EntryPoint> body_entries() {
    constexpr const char *kFb = XR_FB_BODY_TRACKING_EXTENSION_NAME, *kBd = XR_BD_BODY_TRACKING_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY_OF(kFb, nullptr, xrCreateBodyTrackerFB, create_fb),
            NEUVV_XR_ENTRY_OF(kFb, nullptr, xrDestroyBodyTrackerFB, destroy_fb),
            NEUVV_XR_ENTRY_OF(kFb, nullptr, xrLocateBodyJointsFB, locate_fb),
            NEUVV_XR_ENTRY_OF(kBd, nullptr, xrCreateBodyTrackerBD, create_bd),
            NEUVV_XR_ENTRY_OF(kBd, nullptr, xrDestroyBodyTrackerBD, destroy_bd),
            NEUVV_XR_ENTRY_OF(kBd, nullptr, xrLocateBodyJointsBD, locate_bd)};
}

}  // namespace neuvv::xr_runtime
