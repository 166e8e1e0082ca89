// The script that says what the runtime offers and does: NEUVV_XR_SCRIPT; README.md has the file's format.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

enum Hand { kLeft, kRight };

// A value that applies from a frame on. Tracks are sorted by frame.
template <typename T>
struct Key {
    int64_t frame;
    T value;
};
template <typename T>
using Track = std::vector<Key<T>>;

struct HandTracks {
    Track<XrPosef> grip, aim;  // in STAGE
    Track<bool> tracked;
};

struct GazeTracks {
    Track<XrPosef> pose;  // in STAGE
    Track<bool> tracked;
};

struct BodyJoint {
    XrVector3f at = {0, 0, 0};  // in STAGE
    XrSpaceLocationFlags flags = 0;
};
struct BodyTracks {
    Track<bool> active;
    Track<float> confidence;
    std::map<int, Track<BodyJoint>> joints;  // by the number of the extension that the application uses
};

struct ScriptEvent {
    int64_t frame = 0;
    std::string what;  // "do" in the file
    int64_t frames = 1, periods = 3, calls = 0, wait_calls = 10, times = 1;
    bool restart = false, worn = true;
    XrPosef shift = {{0, 0, 0, 1}, {0, 0, 0}};
    std::vector<XrReferenceSpaceType> spaces = {XR_REFERENCE_SPACE_TYPE_LOCAL, xr::kLocalFloorSpace,
                                                XR_REFERENCE_SPACE_TYPE_STAGE};  // that move
    bool says_shift = true, silent = false;
    std::string profile;
    float hz = 0;
};

struct ForcedResult {
    std::string function;
    XrResult result;
    int64_t times;
    int64_t skip;  // so many calls succeed first
};

// The narrow views of a headset that shows two images to each eye.
struct NarrowViews {
    uint32_t width = 256, height = 256;
    XrFovf fov[2] = {};
};

struct Script {
    uint32_t width = 256, height = 256;
    XrFovf fov[2] = {};
    std::optional<NarrowViews> narrow;
    float eye_distance_m = 0.064f, floor_m = -1.6f, refresh_hz = 90;
    std::vector<float> rates_hz = {72, 90};
    bool is_real_time = false, has_mask = true, has_hand_joints = false, has_passthrough = false,
         is_system_available = true;
    std::set<std::string> bodies;  // which body tracking the system has: "fb", "full_body", "bd"
    std::vector<std::string> extensions;
    std::vector<VkFormat> formats;
    std::set<VkFormat> refused_formats;
    std::vector<XrEnvironmentBlendMode> blend_modes = {XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
    std::vector<XrReferenceSpaceType> spaces = {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL,
                                                XR_REFERENCE_SPACE_TYPE_STAGE};
    std::string profile = "/interaction_profiles/oculus/touch_controller";
    Track<XrPosef> head;
    HandTracks hands[2];
    BodyTracks body;
    bool has_gaze = false;  // whether the system tracks eyes
    GazeTracks gaze;
    std::map<std::string, Track<XrPosef>> trackers;   // by role: "left_foot"
    std::map<std::string, Track<XrVector2f>> inputs;  // by full path; scalars in x
    std::vector<ScriptEvent> events;                  // by frame
    std::vector<ForcedResult> forced;
    std::set<int64_t> save_frames;
    int64_t save_every = 0;  // 0: only save_frames
    int64_t end_frame = -1;  // -1: when the application requests it
};

// All extensions that the runtime implements, with their versions.
const std::vector<XrExtensionProperties>& implemented_extensions();

// The name that a script has for a format; empty for formats that it has none for.
std::string name_of_format(int64_t format);
std::string blend_name(XrEnvironmentBlendMode mode);

// Whether the runtime has a function of this name.
bool has_function(const std::string& name);

// An empty `text` gives the defaults. Throws std::runtime_error with the place in the file. Unknown keys are errors, so
// that a test with a misspelt event fails.
Script parse_script(const std::string& text);

// The track's value at a time between frames: interpolated; constant before the first and after the last key;
// `fallback` for a track without keys.
XrPosef pose_at(const Track<XrPosef>& track, double frame, const XrPosef& fallback);

template <typename T>
T value_at(const Track<T>& track, int64_t frame, const T& fallback) {
    T value = fallback;
    for (const Key<T>& key : track) {
        if (key.frame > frame) break;
        value = key.value;
    }
    return value;
}

}  // namespace neuvv::xr_runtime
