// The controllers that the runtime knows: section "Interaction Profile Paths" as data.
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

const std::vector<Profile>& known_profiles();
const Profile* find_profile(const std::string& path);

// The input that a binding path means for an action type, or null: paths may leave the last component to the runtime
// (/input/trigger), which then takes value before click, for boolean actions click before value.
const ProfileInput* find_input(const Profile& profile, const std::string& binding, XrActionType type);
// A path that the profile has in some way, whatever the action.
bool has_input(const Profile& profile, const std::string& binding);
// Whether the action can get its type from the input: a boolean may feed a float and the other way round.
bool is_convertible(InputKind kind, XrActionType type);

}  // namespace neuvv::xr_runtime
