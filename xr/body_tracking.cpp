#include "xr/body_tracking.h"

#include <initializer_list>
#include <vector>

#include "xr/body_joints.h"

namespace neuvv::xr {

namespace {

constexpr const char* kBodyObject = "body";
constexpr std::initializer_list<BodySource> kBodySources = {BodySource::kMetaFullBody, BodySource::kMetaUpperBody,
                                                            BodySource::kBd, BodySource::kWornTrackers,
                                                            BodySource::kThreePoints};

bool is_offered(const Runtime& runtime, BodySource source) {
    switch (source) {
        case BodySource::kMetaFullBody:
            return runtime.supports(XR_FB_BODY_TRACKING_EXTENSION_NAME) &&
                   runtime.supports(XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME);
        case BodySource::kMetaUpperBody:
            return runtime.supports(XR_FB_BODY_TRACKING_EXTENSION_NAME);
        case BodySource::kBd:
            return runtime.supports(XR_BD_BODY_TRACKING_EXTENSION_NAME);
        case BodySource::kWornTrackers:
            return runtime.supports(XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME);
        case BodySource::kThreePoints:
            return true;
    }
    return false;
}

template <typename Location>
std::vector<BodyJointLocation> positions_of(const std::vector<Location>& found) {
    std::vector<BodyJointLocation> joints;
    joints.reserve(found.size());
    for (const Location& joint : found) joints.push_back({joint.locationFlags, joint.pose.position});
    return joints;
}

}  // namespace

BodySource best_body_source(const Runtime& runtime) {
    for (const BodySource source : kBodySources)
        if (is_offered(runtime, source)) return source;
    return BodySource::kThreePoints;
}

const char* title_of(BodySource source) {
    switch (source) {
        case BodySource::kMetaFullBody:
            return "the whole body (Meta's body tracking; legs are guessed where nothing sees them)";
        case BodySource::kMetaUpperBody:
            return "the upper body (Meta's body tracking)";
        case BodySource::kBd:
            return "the whole body (PICO's body tracking)";
        case BodySource::kWornTrackers:
            return "head, hands and worn trackers";
        case BodySource::kThreePoints:
            return "head and hands";
    }
    return "";
}

BodyTracker::BodyTracker(const Session& session) : session_(session) {
    for (const BodySource source : kBodySources) {
        source_ = source;
        if (is_offered(session.runtime(), source) && create(source)) return;
    }
}

BodyTracker::~BodyTracker() {
    if (meta_ != XR_NULL_HANDLE) destroy_meta_(meta_);
    if (bd_ != XR_NULL_HANDLE) destroy_bd_(bd_);
}

bool BodyTracker::create(BodySource source) {
    switch (source) {
        case BodySource::kMetaFullBody:
            return create_meta(XR_BODY_JOINT_SET_FULL_BODY_META);
        case BodySource::kMetaUpperBody:
            return create_meta(XR_BODY_JOINT_SET_DEFAULT_FB);
        case BodySource::kBd:
            return create_bd();
        default:
            return true;
    }
}

bool BodyTracker::create_meta(XrBodyJointSetFB joints) {
    constexpr const char* kCall = "xrCreateBodyTrackerFB";
    const XrBodyTrackerCreateInfoFB info{XR_TYPE_BODY_TRACKER_CREATE_INFO_FB, nullptr, joints};
    const Runtime& runtime = session_.runtime();
    destroy_meta_ = runtime.function<PFN_xrDestroyBodyTrackerFB>("xrDestroyBodyTrackerFB");
    const XrResult result = runtime.function<PFN_xrCreateBodyTrackerFB>(kCall)(session_.handle(), &info, &meta_);
    if (XR_FAILED(result)) meta_ = XR_NULL_HANDLE;
    return succeeded(result, kCall, kBodyObject);
}

bool BodyTracker::create_bd() {
    constexpr const char* kCall = "xrCreateBodyTrackerBD";
    const XrBodyTrackerCreateInfoBD info{XR_TYPE_BODY_TRACKER_CREATE_INFO_BD, nullptr,
                                         XR_BODY_JOINT_SET_FULL_BODY_JOINTS_BD};
    const Runtime& runtime = session_.runtime();
    destroy_bd_ = runtime.function<PFN_xrDestroyBodyTrackerBD>("xrDestroyBodyTrackerBD");
    const XrResult result = runtime.function<PFN_xrCreateBodyTrackerBD>(kCall)(session_.handle(), &info, &bd_);
    if (XR_FAILED(result)) bd_ = XR_NULL_HANDLE;
    return succeeded(result, kCall, kBodyObject);
}

motion::Pose BodyTracker::locate_meta(XrTime time) const {
    constexpr const char* kCall = "xrLocateBodyJointsFB";
    const bool is_full = source_ == BodySource::kMetaFullBody;
    std::vector<XrBodyJointLocationFB> found(is_full ? size_t{XR_FULL_BODY_JOINT_COUNT_META}
                                                     : size_t{XR_BODY_JOINT_COUNT_FB});
    XrBodyJointLocationsFB locations{};
    locations.type = XR_TYPE_BODY_JOINT_LOCATIONS_FB;
    locations.jointCount = static_cast<uint32_t>(found.size());
    locations.jointLocations = found.data();
    const XrBodyJointsLocateInfoFB info{XR_TYPE_BODY_JOINTS_LOCATE_INFO_FB, nullptr, session_.tracking_space(), time};
    const auto locate = session_.runtime().function<PFN_xrLocateBodyJointsFB>(kCall);
    const bool is_located = succeeded(locate(meta_, &info, &locations), kCall, kBodyObject);
    if (!is_located || !locations.isActive) return {};
    return pose_of_body(positions_of(found), kMetaBodySources, static_cast<double>(locations.confidence));
}

motion::Pose BodyTracker::locate_bd(XrTime time) const {
    constexpr const char* kCall = "xrLocateBodyJointsBD";
    std::vector<XrBodyJointLocationBD> found(XR_BODY_JOINT_COUNT_BD);
    XrBodyJointLocationsBD locations{};
    locations.type = XR_TYPE_BODY_JOINT_LOCATIONS_BD;
    locations.jointLocationCount = static_cast<uint32_t>(found.size());
    locations.jointLocations = found.data();
    const XrBodyJointsLocateInfoBD info{XR_TYPE_BODY_JOINTS_LOCATE_INFO_BD, nullptr, session_.tracking_space(), time};
    const auto locate = session_.runtime().function<PFN_xrLocateBodyJointsBD>(kCall);
    if (!succeeded(locate(bd_, &info, &locations), kCall, kBodyObject)) return {};
    return pose_of_body(positions_of(found), kBdBodySources, 1);
}

std::optional<motion::Pose> BodyTracker::locate(const BodyPoints& points, XrTime time) const {
    if (meta_ == XR_NULL_HANDLE && bd_ == XR_NULL_HANDLE) return pose_of_points(points);
    motion::Pose pose = meta_ != XR_NULL_HANDLE ? locate_meta(time) : locate_bd(time);
    if (!has_joints(pose)) return std::nullopt;
    if (points.head && is_valid(*points.head) && is_near(nose_of(*points.head)))
        motion::at(pose, motion::Joint::kNose) = {nose_of(*points.head), 1, true};
    return pose;
}

}  // namespace neuvv::xr
