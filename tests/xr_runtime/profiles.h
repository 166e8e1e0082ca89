// The controllers that the runtime knows: the specification's section "Interaction Profile Paths" as data.
#pragma once

#include <string>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

enum class InputKind { kBoolean, kFloat, kVector, kPose, kHaptic };

struct ProfileInput {
    const char* path;  // below /user/hand/left or right
    InputKind kind;
    enum Side { kBoth, kLeftOnly, kRightOnly } side;
};

struct Profile {
    const char* path;
    const char* name;       // for people
    const char* extension;  // null: core
    std::vector<ProfileInput> inputs;
};

// Trackers that are worn have user paths by role: "/user/vive_tracker_htcx/role/waist".
inline constexpr const char* kTrackerProfile = "/interaction_profiles/htc/vive_tracker_htcx";
inline constexpr const char* kTrackerRoot = "/user/vive_tracker_htcx/role/";
// Where the eyes look, with a user path of its own.
inline constexpr const char* kGazeProfile = "/interaction_profiles/ext/eye_gaze_interaction";
inline constexpr const char* kGazeUser = "/user/eyes_ext";
// "/user/hand/left" of "/user/hand/left/input/grip/pose".
std::string user_of(const std::string& binding);

const std::vector<Profile>& known_profiles();
const Profile* find_profile(const std::string& path);

// The input that a binding path means for an action type, or null. A path may omit the last component (/input/trigger);
// the runtime then prefers value to click, and for boolean actions click to value.
const ProfileInput* find_input(const Profile& profile, const std::string& binding, XrActionType type);
// Whether the path means an input of the profile for any type of action.
bool has_input(const Profile& profile, const std::string& binding);
// Whether an input can be the source of an action of this type: booleans and floats convert to each other.
bool is_convertible(InputKind kind, XrActionType type);

}  // namespace neuvv::xr_runtime
