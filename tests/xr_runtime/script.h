// What a test wants the runtime to be and to do: NEUVV_XR_SCRIPT, see README.md for the file.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

enum Hand { kLeft, kRight };

// Values that hold from a frame on, in order of frames.
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

struct ScriptEvent {
    int64_t frame = 0;
    std::string what;  // "do" in the file
    int64_t frames = 1, periods = 3, calls = 0, wait_calls = 10;
    bool restart = false;
    XrPosef shift = {{0, 0, 0, 1}, {0, 0, 0}};
    std::string profile;
    float hz = 0;
};

struct ForcedResult {
    std::string function;
    XrResult result;
    int64_t times;
    int64_t skip;  // calls that go through first
};

struct Script {
    uint32_t width = 256, height = 256;
    XrFovf fov[2] = {};
    float eye_distance_m = 0.064f, floor_m = -1.6f, refresh_hz = 90;
    std::vector<float> rates_hz = {72, 90};
    bool is_real_time = false, has_mask = true, has_hand_joints = false, is_system_available = true;
    std::vector<std::string> extensions;
    std::vector<VkFormat> formats;
    std::set<VkFormat> refused_formats;
    std::vector<XrEnvironmentBlendMode> blend_modes = {XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
    std::vector<XrReferenceSpaceType> spaces = {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL,
                                                XR_REFERENCE_SPACE_TYPE_STAGE};
    std::string profile = "/interaction_profiles/oculus/touch_controller";
    Track<XrPosef> head;
    HandTracks hands[2];
    std::map<std::string, Track<XrVector2f>> inputs;  // by full path; scalars in x
    std::vector<ScriptEvent> events;                  // by frame
    std::vector<ForcedResult> forced;
    std::set<int64_t> save_frames;
    int64_t save_every = 0;  // 0: only those named
    int64_t end_frame = -1;  // -1: when the application asks
};

// Every extension that the runtime implements, with its version.
const std::vector<XrExtensionProperties>& implemented_extensions();

// Whether the runtime has a function of this name.
bool has_function(const std::string& name);

// The defaults where `text` is empty. Throws std::runtime_error naming the place in the file: keys that no table of
// README.md has are errors, so that a misspelt event does not test nothing.
Script parse_script(const std::string& text);

// The track's value at a moment between frames: interpolated, the first and last held outside. `fallback` if empty.
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
