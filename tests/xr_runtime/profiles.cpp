#include "profiles.h"

#include <algorithm>
#include <string_view>

namespace neuvv::xr_runtime {

namespace {

constexpr InputKind kBoolean = InputKind::kBoolean, kFloat = InputKind::kFloat, kVector = InputKind::kVector,
                    kPose = InputKind::kPose, kHaptic = InputKind::kHaptic;

using Inputs = std::vector<ProfileInput>;

// The inputs of both. This is no operator+, as that would hide the one of vectors where both files are compiled as one.
Inputs operator|(Inputs a, const Inputs& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

const Inputs kPoses = {{"/input/grip/pose", kPose, ProfileInput::kBoth},
                       {"/input/aim/pose", kPose, ProfileInput::kBoth}};
const Inputs kBuzz = {{"/output/haptic", kHaptic, ProfileInput::kBoth}};

Inputs booleans(std::initializer_list<const char*> paths, ProfileInput::Side side = ProfileInput::kBoth) {
    Inputs inputs;
    for (const char* path : paths) inputs.push_back({path, kBoolean, side});
    return inputs;
}
Inputs floats(std::initializer_list<const char*> paths) {
    Inputs inputs;
    for (const char* path : paths) inputs.push_back({path, kFloat, ProfileInput::kBoth});
    return inputs;
}

const Inputs kThumbstick = Inputs{{"/input/thumbstick", kVector, ProfileInput::kBoth}} |
                           floats({"/input/thumbstick/x", "/input/thumbstick/y"}) |
                           booleans({"/input/thumbstick/click"});
const Inputs kTrackpad = Inputs{{"/input/trackpad", kVector, ProfileInput::kBoth}} |
                         floats({"/input/trackpad/x", "/input/trackpad/y"}) | booleans({"/input/trackpad/touch"});

const Inputs kTouchButtons =
    booleans({"/input/x/click", "/input/x/touch", "/input/y/click", "/input/y/touch", "/input/menu/click"},
             ProfileInput::kLeftOnly) |
    booleans({"/input/a/click", "/input/a/touch", "/input/b/click", "/input/b/touch", "/input/system/click"},
             ProfileInput::kRightOnly);
const Inputs kTouchInputs = floats({"/input/squeeze/value", "/input/trigger/value"}) | kThumbstick |
                            booleans({"/input/trigger/touch", "/input/thumbstick/touch", "/input/thumbrest/touch"}) |
                            kPoses | kBuzz;

// The index of the hand to which a path belongs, 2 for a worn tracker and for the eyes; -1 for none that the profile
// has.
int side_of(const Profile& profile, const std::string& binding) {
    if (profile.path == std::string_view(kTrackerProfile)) return binding.starts_with(kTrackerRoot) ? 2 : -1;
    if (profile.path == std::string_view(kGazeProfile)) return user_of(binding) == kGazeUser ? 2 : -1;
    if (binding.starts_with("/user/hand/left/")) return 0;
    return binding.starts_with("/user/hand/right/") ? 1 : -1;
}

const ProfileInput* exact(const Profile& profile, const std::string& rest, int side) {
    const auto other = side == 0 ? ProfileInput::kRightOnly : ProfileInput::kLeftOnly;
    for (const ProfileInput& input : profile.inputs)
        if (rest == input.path && input.side != other) return &input;
    return nullptr;
}

std::string below_user(const std::string& binding) {
    return binding.substr(user_of(binding).size());
}

}  // namespace

std::string user_of(const std::string& binding) {
    return binding.substr(0, std::min(binding.find("/input/"), binding.find("/output/")));
}

const std::vector<Profile>& known_profiles() {
    static const std::vector<Profile> profiles = {
        {"/interaction_profiles/khr/simple_controller", "Simple Controller", nullptr,
         booleans({"/input/select/click", "/input/menu/click"}) | kPoses | kBuzz},
        {"/interaction_profiles/khr/generic_controller", "Generic Controller", "XR_KHR_generic_controller",
         booleans({"/input/primary/click", "/input/secondary/click"}) |
             floats({"/input/squeeze/value", "/input/trigger/value"}) | kThumbstick | kPoses | kBuzz},
        {"/interaction_profiles/oculus/touch_controller", "Touch Controller", nullptr, kTouchButtons | kTouchInputs},
        {"/interaction_profiles/valve/index_controller", "Index Controller", nullptr,
         booleans({"/input/system/click", "/input/system/touch", "/input/a/click", "/input/a/touch", "/input/b/click",
                   "/input/b/touch", "/input/trigger/click", "/input/trigger/touch", "/input/thumbstick/touch"}) |
             floats({"/input/squeeze/value", "/input/squeeze/force", "/input/trigger/value", "/input/trackpad/force"}) |
             kThumbstick | kTrackpad | kPoses | kBuzz},
        {"/interaction_profiles/htc/vive_controller", "Vive Controller", nullptr,
         booleans({"/input/system/click", "/input/squeeze/click", "/input/menu/click", "/input/trigger/click",
                   "/input/trackpad/click"}) |
             floats({"/input/trigger/value"}) | kTrackpad | kPoses | kBuzz},
        {"/interaction_profiles/microsoft/motion_controller", "Motion Controller", nullptr,
         booleans({"/input/menu/click", "/input/squeeze/click", "/input/trackpad/click"}) |
             floats({"/input/trigger/value"}) | kThumbstick | kTrackpad | kPoses | kBuzz},
        {"/interaction_profiles/google/daydream_controller", "Daydream Controller", nullptr,
         booleans({"/input/select/click", "/input/trackpad/click"}) | kTrackpad | kPoses},
        {"/interaction_profiles/oculus/go_controller", "Go Controller", nullptr,
         booleans({"/input/system/click", "/input/trigger/click", "/input/back/click", "/input/trackpad/click"}) |
             kTrackpad | kPoses},
        {kTrackerProfile,
         "Vive Tracker",
         XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME,
         {{"/input/grip/pose", kPose, ProfileInput::kBoth}}},
        {kGazeProfile,
         "Gaze",
         XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
         {{"/input/gaze_ext/pose", kPose, ProfileInput::kBoth}}},
        {"/interaction_profiles/facebook/touch_controller_pro", "Touch Pro Controller", "XR_FB_touch_controller_pro",
         kTouchButtons | kTouchInputs},
        {"/interaction_profiles/meta/touch_controller_plus", "Touch Plus Controller", "XR_META_touch_controller_plus",
         kTouchButtons | kTouchInputs},
        {"/interaction_profiles/bytedance/pico4_controller", "PICO 4 Controller", "XR_BD_controller_interaction",
         kTouchButtons | booleans({"/input/squeeze/click", "/input/trigger/touch", "/input/thumbstick/touch"}) |
             floats({"/input/squeeze/value", "/input/trigger/value"}) | kThumbstick | kPoses | kBuzz},
        {"/interaction_profiles/htc/vive_focus3_controller", "Focus 3 Controller",
         "XR_HTC_vive_focus3_controller_interaction",
         kTouchButtons |
             booleans({"/input/squeeze/click", "/input/squeeze/touch", "/input/trigger/click", "/input/trigger/touch",
                       "/input/thumbstick/touch", "/input/thumbrest/touch"}) |
             floats({"/input/trigger/value"}) | kThumbstick | kPoses | kBuzz},
        {"/interaction_profiles/hp/mixed_reality_controller", "HP Controller", "XR_EXT_hp_mixed_reality_controller",
         booleans({"/input/x/click", "/input/y/click"}, ProfileInput::kLeftOnly) |
             booleans({"/input/a/click", "/input/b/click"}, ProfileInput::kRightOnly) |
             booleans({"/input/menu/click"}) | floats({"/input/squeeze/value", "/input/trigger/value"}) | kThumbstick |
             kPoses | kBuzz},
        {"/interaction_profiles/ml/ml2_controller", "Magic Leap 2 Controller", "XR_ML_ml2_controller_interaction",
         booleans({"/input/menu/click", "/input/home/click", "/input/trigger/click", "/input/shoulder/click",
                   "/input/trackpad/click"}) |
             floats({"/input/trigger/value", "/input/trackpad/force"}) | kTrackpad | kPoses | kBuzz},
        {"/interaction_profiles/microsoft/hand_interaction", "Hand", XR_MSFT_HAND_INTERACTION_EXTENSION_NAME,
         floats({"/input/select/value", "/input/squeeze/value"}) | kPoses},
        {"/interaction_profiles/ext/hand_interaction_ext", "Hand", "XR_EXT_hand_interaction",
         floats({"/input/pinch_ext/value", "/input/aim_activate_ext/value", "/input/grasp_ext/value"}) |
             booleans(
                 {"/input/pinch_ext/ready_ext", "/input/aim_activate_ext/ready_ext", "/input/grasp_ext/ready_ext"}) |
             Inputs{{"/input/pinch_ext/pose", kPose, ProfileInput::kBoth},
                    {"/input/poke_ext/pose", kPose, ProfileInput::kBoth}} |
             kPoses},
    };
    return profiles;
}

const Profile* find_profile(const std::string& path) {
    for (const Profile& profile : known_profiles())
        if (path == profile.path) return &profile;
    return nullptr;
}

bool has_input(const Profile& profile, const std::string& binding) {
    const int side = side_of(profile, binding);
    if (side < 0) return false;
    const std::string rest = below_user(binding);
    if (exact(profile, rest, side)) return true;
    for (const char* component : {"/value", "/click", "/pose", "/touch"})
        if (exact(profile, rest + component, side)) return true;
    return false;
}

const ProfileInput* find_input(const Profile& profile, const std::string& binding, XrActionType type) {
    const int side = side_of(profile, binding);
    if (side < 0) return nullptr;
    const std::string rest = below_user(binding);
    const ProfileInput* input = exact(profile, rest, side);
    if (input && is_convertible(input->kind, type)) return input;
    const bool is_boolean = type == XR_ACTION_TYPE_BOOLEAN_INPUT;
    for (const char* component : {is_boolean ? "/click" : "/value", is_boolean ? "/value" : "/click", "/pose"}) {
        const ProfileInput* below = exact(profile, rest + component, side);
        if (below && is_convertible(below->kind, type)) return below;
    }
    return nullptr;
}

bool is_convertible(InputKind kind, XrActionType type) {
    switch (type) {
        case XR_ACTION_TYPE_BOOLEAN_INPUT:
        case XR_ACTION_TYPE_FLOAT_INPUT:
            return kind == kBoolean || kind == kFloat;
        case XR_ACTION_TYPE_VECTOR2F_INPUT:
            return kind == kVector;
        case XR_ACTION_TYPE_POSE_INPUT:
            return kind == kPose;
        case XR_ACTION_TYPE_VIBRATION_OUTPUT:
            return kind == kHaptic;
        default:
            return false;
    }
}

}  // namespace neuvv::xr_runtime
