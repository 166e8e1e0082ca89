// What the headers of OpenXR say of bodies from 1.1 on, for older headers: numbers and layouts are those of the Khronos
// registry. Of the joints, only those that this program uses are named.
#pragma once

#include <openxr/openxr.h>

#ifndef XR_FB_body_tracking
#define XR_FB_body_tracking 1
#define XR_FB_body_tracking_SPEC_VERSION 1
#define XR_FB_BODY_TRACKING_EXTENSION_NAME "XR_FB_body_tracking"
XR_DEFINE_HANDLE(XrBodyTrackerFB)

constexpr auto XR_TYPE_BODY_TRACKER_CREATE_INFO_FB = static_cast<XrStructureType>(1000076001);
constexpr auto XR_TYPE_BODY_JOINTS_LOCATE_INFO_FB = static_cast<XrStructureType>(1000076002);
constexpr auto XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_FB = static_cast<XrStructureType>(1000076004);
constexpr auto XR_TYPE_BODY_JOINT_LOCATIONS_FB = static_cast<XrStructureType>(1000076005);

enum XrBodyJointFB {
    XR_BODY_JOINT_HIPS_FB = 1,
    XR_BODY_JOINT_LEFT_ARM_UPPER_FB = 10,
    XR_BODY_JOINT_LEFT_ARM_LOWER_FB = 11,
    XR_BODY_JOINT_RIGHT_ARM_UPPER_FB = 15,
    XR_BODY_JOINT_RIGHT_ARM_LOWER_FB = 16,
    XR_BODY_JOINT_LEFT_HAND_WRIST_FB = 19,
    XR_BODY_JOINT_RIGHT_HAND_WRIST_FB = 45,
    XR_BODY_JOINT_COUNT_FB = 70,
    XR_BODY_JOINT_MAX_ENUM_FB = 0x7FFFFFFF
};

enum XrBodyJointSetFB { XR_BODY_JOINT_SET_DEFAULT_FB = 0, XR_BODY_JOINT_SET_MAX_ENUM_FB = 0x7FFFFFFF };

struct XrSystemBodyTrackingPropertiesFB {
    XrStructureType type;
    void* next;
    XrBool32 supportsBodyTracking;
};

struct XrBodyTrackerCreateInfoFB {
    XrStructureType type;
    const void* next;
    XrBodyJointSetFB bodyJointSet;
};

struct XrBodyJointsLocateInfoFB {
    XrStructureType type;
    const void* next;
    XrSpace baseSpace;
    XrTime time;
};

struct XrBodyJointLocationFB {
    XrSpaceLocationFlags locationFlags;
    XrPosef pose;
};

struct XrBodyJointLocationsFB {
    XrStructureType type;
    void* next;
    XrBool32 isActive;
    float confidence;
    uint32_t jointCount;
    XrBodyJointLocationFB* jointLocations;
    uint32_t skeletonChangedCount;
    XrTime time;
};

using PFN_xrCreateBodyTrackerFB = XrResult(XRAPI_PTR*)(XrSession session, const XrBodyTrackerCreateInfoFB* createInfo,
                                                       XrBodyTrackerFB* bodyTracker);
using PFN_xrDestroyBodyTrackerFB = XrResult(XRAPI_PTR*)(XrBodyTrackerFB bodyTracker);
using PFN_xrLocateBodyJointsFB = XrResult(XRAPI_PTR*)(XrBodyTrackerFB bodyTracker,
                                                      const XrBodyJointsLocateInfoFB* locateInfo,
                                                      XrBodyJointLocationsFB* locations);
#endif

#ifndef XR_META_body_tracking_full_body
#define XR_META_body_tracking_full_body 1
#define XR_META_body_tracking_full_body_SPEC_VERSION 1
#define XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME "XR_META_body_tracking_full_body"

constexpr auto XR_TYPE_SYSTEM_PROPERTIES_BODY_TRACKING_FULL_BODY_META = static_cast<XrStructureType>(1000274000);
constexpr auto XR_BODY_JOINT_SET_FULL_BODY_META = static_cast<XrBodyJointSetFB>(1000274000);

// The first 70 are those of XrBodyJointFB.
enum XrFullBodyJointMETA {
    XR_FULL_BODY_JOINT_LEFT_UPPER_LEG_META = 70,
    XR_FULL_BODY_JOINT_LEFT_LOWER_LEG_META = 71,
    XR_FULL_BODY_JOINT_LEFT_FOOT_ANKLE_META = 73,
    XR_FULL_BODY_JOINT_LEFT_FOOT_BALL_META = 76,
    XR_FULL_BODY_JOINT_RIGHT_UPPER_LEG_META = 77,
    XR_FULL_BODY_JOINT_RIGHT_LOWER_LEG_META = 78,
    XR_FULL_BODY_JOINT_RIGHT_FOOT_ANKLE_META = 80,
    XR_FULL_BODY_JOINT_RIGHT_FOOT_BALL_META = 83,
    XR_FULL_BODY_JOINT_COUNT_META = 84,
    XR_FULL_BODY_JOINT_MAX_ENUM_META = 0x7FFFFFFF
};

struct XrSystemPropertiesBodyTrackingFullBodyMETA {
    XrStructureType type;
    void* next;
    XrBool32 supportsFullBodyTracking;
};
#endif

#ifndef XR_BD_body_tracking
#define XR_BD_body_tracking 1
#define XR_BD_body_tracking_SPEC_VERSION 1
#define XR_BD_BODY_TRACKING_EXTENSION_NAME "XR_BD_body_tracking"
#define XR_BODY_JOINT_COUNT_BD 24
XR_DEFINE_HANDLE(XrBodyTrackerBD)

constexpr auto XR_TYPE_BODY_TRACKER_CREATE_INFO_BD = static_cast<XrStructureType>(1000385001);
constexpr auto XR_TYPE_BODY_JOINTS_LOCATE_INFO_BD = static_cast<XrStructureType>(1000385002);
constexpr auto XR_TYPE_BODY_JOINT_LOCATIONS_BD = static_cast<XrStructureType>(1000385003);
constexpr auto XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_BD = static_cast<XrStructureType>(1000385004);

enum XrBodyJointBD {
    XR_BODY_JOINT_LEFT_HIP_BD = 1,
    XR_BODY_JOINT_RIGHT_HIP_BD = 2,
    XR_BODY_JOINT_LEFT_KNEE_BD = 4,
    XR_BODY_JOINT_RIGHT_KNEE_BD = 5,
    XR_BODY_JOINT_LEFT_ANKLE_BD = 7,
    XR_BODY_JOINT_RIGHT_ANKLE_BD = 8,
    XR_BODY_JOINT_LEFT_FOOT_BD = 10,
    XR_BODY_JOINT_RIGHT_FOOT_BD = 11,
    XR_BODY_JOINT_LEFT_SHOULDER_BD = 16,
    XR_BODY_JOINT_RIGHT_SHOULDER_BD = 17,
    XR_BODY_JOINT_LEFT_ELBOW_BD = 18,
    XR_BODY_JOINT_RIGHT_ELBOW_BD = 19,
    XR_BODY_JOINT_LEFT_WRIST_BD = 20,
    XR_BODY_JOINT_RIGHT_WRIST_BD = 21,
    XR_BODY_JOINT_MAX_ENUM_BD = 0x7FFFFFFF
};

enum XrBodyJointSetBD {
    XR_BODY_JOINT_SET_BODY_WITHOUT_ARM_BD = 1,
    XR_BODY_JOINT_SET_FULL_BODY_JOINTS_BD = 2,
    XR_BODY_JOINT_SET_MAX_ENUM_BD = 0x7FFFFFFF
};

struct XrSystemBodyTrackingPropertiesBD {
    XrStructureType type;
    void* next;
    XrBool32 supportsBodyTracking;
};

struct XrBodyTrackerCreateInfoBD {
    XrStructureType type;
    const void* next;
    XrBodyJointSetBD jointSet;
};

struct XrBodyJointsLocateInfoBD {
    XrStructureType type;
    const void* next;
    XrSpace baseSpace;
    XrTime time;
};

struct XrBodyJointLocationBD {
    XrSpaceLocationFlags locationFlags;
    XrPosef pose;
};

struct XrBodyJointLocationsBD {
    XrStructureType type;
    void* next;
    XrBool32 allJointPosesTracked;
    uint32_t jointLocationCount;
    XrBodyJointLocationBD* jointLocations;
};

using PFN_xrCreateBodyTrackerBD = XrResult(XRAPI_PTR*)(XrSession session, const XrBodyTrackerCreateInfoBD* createInfo,
                                                       XrBodyTrackerBD* bodyTracker);
using PFN_xrDestroyBodyTrackerBD = XrResult(XRAPI_PTR*)(XrBodyTrackerBD bodyTracker);
using PFN_xrLocateBodyJointsBD = XrResult(XRAPI_PTR*)(XrBodyTrackerBD bodyTracker,
                                                      const XrBodyJointsLocateInfoBD* locateInfo,
                                                      XrBodyJointLocationsBD* locations);
#endif

// The layouts on machines of 64 bits, which all headsets' runtimes have.
static_assert(sizeof(void*) == 8);
static_assert(sizeof(XrSystemBodyTrackingPropertiesFB) == 24 && sizeof(XrSystemBodyTrackingPropertiesBD) == 24);
static_assert(sizeof(XrSystemPropertiesBodyTrackingFullBodyMETA) == 24);
static_assert(sizeof(XrBodyTrackerCreateInfoFB) == 24 && sizeof(XrBodyTrackerCreateInfoBD) == 24);
static_assert(sizeof(XrBodyJointsLocateInfoFB) == 32 && sizeof(XrBodyJointsLocateInfoBD) == 32);
static_assert(sizeof(XrBodyJointLocationFB) == 40 && sizeof(XrBodyJointLocationBD) == 40);
static_assert(sizeof(XrBodyJointLocationsFB) == 56 && sizeof(XrBodyJointLocationsBD) == 32);
static_assert(XR_BODY_JOINT_SET_FULL_BODY_META == 1000274000 && XR_BODY_JOINT_COUNT_FB == 70);
static_assert(XR_FULL_BODY_JOINT_COUNT_META == 84 && XR_BODY_JOINT_COUNT_BD == 24);
