// The whole state of the runtime. A process has one Runtime, whose mutex each entry point holds.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "openxr_all.h"
#include "report.h"
#include "script.h"
#include "vulkan_images.h"

namespace neuvv::xr_runtime {

enum class Kind : uint8_t {
    kInstance = 1,
    kSession,
    kSpace,
    kSwapchain,
    kActionSet,
    kAction,
    kHandTracker,
    kBodyTrackerFb,
    kBodyTrackerBd,
    kPassthrough,
    kPassthroughLayer,
    kMessenger
};

struct Session;

struct ActionSet {
    static constexpr Kind kKind = Kind::kActionSet;
    static constexpr const char* kName = "XrActionSet";
    using Handle = XrActionSet;
    Handle handle = XR_NULL_HANDLE;
    std::string name, localized_name;
    uint32_t priority = 0;
    bool is_attached = false;
};

struct Action {
    static constexpr Kind kKind = Kind::kAction;
    static constexpr const char* kName = "XrAction";
    using Handle = XrAction;
    Handle handle = XR_NULL_HANDLE;
    std::shared_ptr<ActionSet> set;  // outlives the set's handle: attached actions keep working
    std::string name, localized_name;
    XrActionType type = XR_ACTION_TYPE_MAX_ENUM;
    std::vector<XrPath> subaction_paths;
};

// A suggested binding; `path` is what the application wrote.
struct Binding {
    std::shared_ptr<Action> action;
    std::string path;
};

struct Instance {
    static constexpr Kind kKind = Kind::kInstance;
    static constexpr const char* kName = "XrInstance";
    using Handle = XrInstance;
    Handle handle = XR_NULL_HANDLE;
    std::set<std::string> extensions;
    bool has_system = false, asked_requirements = false, asked_requirements2 = false;
    std::map<VkInstance, PFN_vkGetInstanceProcAddr> vulkan_instances;  // of xrCreateVulkanInstanceKHR
    std::map<VkDevice, VkPhysicalDevice> vulkan_devices;               // of xrCreateVulkanDeviceKHR
    std::map<VkInstance, VkPhysicalDevice> graphics_devices;           // what xrGetVulkanGraphicsDevice(2)KHR returned
    std::deque<XrEventDataBuffer> events;
    int64_t last_poll_frame = 0;
    XrPath first_path = 1;  // differs by instance, as paths belong to one instance
    std::vector<std::string> paths;
    std::map<std::string, std::vector<Binding>> suggested;  // by interaction profile
    bool is_lost = false;
    int64_t calls_until_loss = -1;  // -1: no loss is pending

    bool has(const char* extension) const { return extensions.contains(extension); }
};

struct Swapchain {
    static constexpr Kind kKind = Kind::kSwapchain;
    static constexpr const char* kName = "XrSwapchain";
    using Handle = XrSwapchain;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    XrSwapchainCreateInfo info = {};
    SwapchainImages images;
    std::deque<uint32_t> acquired;  // the oldest first
    bool is_oldest_waited = false;
    uint32_t next = 0;
    std::optional<uint32_t> released;  // the latest
    int64_t released_count = 0;
    int64_t shown_count = 0;  // released_count as of the last xrEndFrame that used it
};

struct Space {
    static constexpr Kind kKind = Kind::kSpace;
    static constexpr const char* kName = "XrSpace";
    using Handle = XrSpace;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    XrReferenceSpaceType reference = XR_REFERENCE_SPACE_TYPE_MAX_ENUM;  // for reference spaces
    std::shared_ptr<Action> action;                                     // for action spaces
    XrPath subaction_path = XR_NULL_PATH;
    XrPosef offset = {{0, 0, 0, 1}, {0, 0, 0}};
};

struct HandTracker {
    static constexpr Kind kKind = Kind::kHandTracker;
    static constexpr const char* kName = "XrHandTrackerEXT";
    using Handle = XrHandTrackerEXT;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    Hand hand = kLeft;
};

struct BodyTrackerFb {
    static constexpr Kind kKind = Kind::kBodyTrackerFb;
    static constexpr const char* kName = "XrBodyTrackerFB";
    using Handle = XrBodyTrackerFB;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    uint32_t joint_count = 0;
};

struct BodyTrackerBd {
    static constexpr Kind kKind = Kind::kBodyTrackerBd;
    static constexpr const char* kName = "XrBodyTrackerBD";
    using Handle = XrBodyTrackerBD;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    uint32_t joint_count = 0;
};

struct Passthrough {
    static constexpr Kind kKind = Kind::kPassthrough;
    static constexpr const char* kName = "XrPassthroughFB";
    using Handle = XrPassthroughFB;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    bool is_running = false;
    int64_t last_frame = INT64_MAX;  // after it, the application must have created another one
};

struct PassthroughLayer {
    static constexpr Kind kKind = Kind::kPassthroughLayer;
    static constexpr const char* kName = "XrPassthroughLayerFB";
    using Handle = XrPassthroughLayerFB;
    Handle handle = XR_NULL_HANDLE;
    Session* session = nullptr;
    std::shared_ptr<Passthrough> passthrough;
    bool is_running = false;
};

struct Messenger {
    static constexpr Kind kKind = Kind::kMessenger;
    static constexpr const char* kName = "XrDebugUtilsMessengerEXT";
    using Handle = XrDebugUtilsMessengerEXT;
    Handle handle = XR_NULL_HANDLE;
};

struct Frame {
    int64_t index = -1;
    XrTime display_time = 0;
    bool should_render = false;
    int locate_count = 0;
    bool follows_gaze = false;  // whether the last xrLocateViews moved the narrow views to where the eyes look
};

// The state of an action for one subaction path (or for none), as of the last xrSyncActions.
struct ActionState {
    bool is_active = false, has_changed = false;
    XrVector2f value = {0, 0};
    XrTime change_time = 0;
    std::string source;  // the path of the binding; for poses, it names the hand and grip or aim
};

enum class AfterStop { kNothing, kRestart, kExit };

struct Session {
    static constexpr Kind kKind = Kind::kSession;
    static constexpr const char* kName = "XrSession";
    using Handle = XrSession;
    Handle handle = XR_NULL_HANDLE;
    Instance* instance = nullptr;
    VulkanDevice vulkan;
    XrSessionState state = XR_SESSION_STATE_UNKNOWN;
    XrSessionState target = XR_SESSION_STATE_FOCUSED;  // the state that the session goes to with each finished frame
    XrViewConfigurationType views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;  // since xrBeginSession
    bool is_running = false, is_lost = false;
    AfterStop after_stop = AfterStop::kNothing;
    int64_t restart_polls = 0;  // how many empty xrPollEvent calls, in IDLE, come before READY
    int64_t ended_frames = 0;   // since xrBeginSession
    std::optional<Frame> waited, begun;
    std::thread::id waiter, beginner;
    bool is_attached = false, was_synced = false;
    std::vector<std::shared_ptr<ActionSet>> attached;
    std::string current_profile;  // empty: no controllers
    std::map<std::pair<XrAction, XrPath>, ActionState> action_states;
};

struct Recentre {
    XrTime change_time;
    XrReferenceSpaceType space;
    XrPosef shift;
};

// The position in the script. It outlives instances and sessions, so that the script continues after a loss.
struct Progress {
    std::vector<XrTime> display_times;  // by frame
    XrTime last_wake = 0;               // only where time is real
    size_t next_event = 0;
    int64_t slow_until = 0, slow_periods = 1, untracked_until = 0;
    std::vector<Recentre> recentres;
    float refresh_hz = 90;
    std::string profile;
    int mask_version = 0;
    XrTime clock_base = 0;  // XrTime minus CLOCK_MONOTONIC, in nanoseconds

    int64_t frame() const { return static_cast<int64_t>(display_times.size()) - 1; }
    XrDuration period() const { return static_cast<XrDuration>(1e9 / static_cast<double>(refresh_hz) + 0.5); }
};

struct Runtime {
    std::mutex mutex;
    std::condition_variable frame_begun;
    std::string configuration;  // script and folder to which the members below belong
    Script script;
    Report report;
    Progress progress;
    std::map<uint64_t, std::shared_ptr<void>> objects;
    uint64_t next_serial = 1;
    std::shared_ptr<Instance> instance;  // there is at most one
    std::shared_ptr<Session> session;    // there is at most one
};

Runtime& runtime();

// The present XrTime.
XrTime now();
// The index, with a fraction, of the frame that is on display at this time: the script's clock.
double frame_at(XrTime time);

}  // namespace neuvv::xr_runtime
