#include "script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "pose.h"

namespace neuvv::xr_runtime {

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& place, const std::string& problem) {
    throw std::runtime_error(fmt::format("{}: {}", place, problem));
}

// An object of the script all of whose keys must be read: one that is left at the end is misspelt.
class Fields {
  public:
    Fields(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
        if (!json.is_object()) fail(place_, "an object is wanted");
    }

    const Json* find(const std::string& key) {
        asked_.insert(key);
        const auto found = json_.find(key);
        return found == json_.end() ? nullptr : &*found;
    }
    template <typename T>
    void read(const std::string& key, T& value) {
        const Json* found = find(key);
        if (!found) return;
        try {
            value = found->get<T>();
        } catch (const Json::exception& error) {
            fail(at(key), error.what());
        }
    }
    std::string at(const std::string& key) const { return place_ + "/" + key; }
    void finish() const {
        for (const auto& [key, value] : json_.items())
            if (!asked_.contains(key) && key != "comment") fail(at(key), "unknown key");
    }

  private:
    const Json& json_;
    std::string place_;
    std::set<std::string> asked_;
};

template <typename T>
struct Named {
    const char* name;
    T value;
};

template <typename T, size_t kCount>
T named(const Named<T> (&table)[kCount], const std::string& name, const std::string& place) {
    for (const Named<T>& entry : table)
        if (name == entry.name) return entry.value;
    fail(place, "unknown name '" + name + "'");
}

constexpr Named<VkFormat> kFormats[] = {{"R8G8B8A8_SRGB", VK_FORMAT_R8G8B8A8_SRGB},
                                        {"B8G8R8A8_SRGB", VK_FORMAT_B8G8R8A8_SRGB},
                                        {"R16G16B16A16_SFLOAT", VK_FORMAT_R16G16B16A16_SFLOAT},
                                        {"R8G8B8A8_UNORM", VK_FORMAT_R8G8B8A8_UNORM},
                                        {"B8G8R8A8_UNORM", VK_FORMAT_B8G8R8A8_UNORM},
                                        {"D32_SFLOAT", VK_FORMAT_D32_SFLOAT},
                                        {"D16_UNORM", VK_FORMAT_D16_UNORM}};
constexpr Named<XrEnvironmentBlendMode> kBlendModes[] = {{"opaque", XR_ENVIRONMENT_BLEND_MODE_OPAQUE},
                                                         {"additive", XR_ENVIRONMENT_BLEND_MODE_ADDITIVE},
                                                         {"alpha_blend", XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND}};
constexpr Named<XrReferenceSpaceType> kSpaces[] = {{"view", XR_REFERENCE_SPACE_TYPE_VIEW},
                                                   {"local", XR_REFERENCE_SPACE_TYPE_LOCAL},
                                                   {"local_floor", xr::kLocalFloorSpace},
                                                   {"stage", XR_REFERENCE_SPACE_TYPE_STAGE}};
#define NEUVV_XR_RESULT(name, value) {#name, name},
constexpr Named<XrResult> kResults[] = {XR_LIST_ENUM_XrResult(NEUVV_XR_RESULT)};
#undef NEUVV_XR_RESULT
constexpr const char* kEvents[] = {"visible",      "synchronized",      "focus",       "stop",     "exit",
                                   "lose_session", "lose_instance",     "recentre",    "slow",     "profile",
                                   "mask_changed", "refresh",           "no_tracking", "presence", "passthrough_lost",
                                   "lose_device",  "validation_message"};

template <typename T, size_t kCount>
void read_names(Fields& fields, const std::string& key, const Named<T> (&table)[kCount], std::vector<T>& values) {
    std::vector<std::string> names;
    if (!fields.find(key)) return;
    fields.read(key, names);
    values.clear();
    for (const std::string& name : names) values.push_back(named(table, name, fields.at(key)));
}

void read_pose(Fields fields, XrPosef& pose) {
    std::array<float, 3> at = {}, turn_deg = {};
    fields.read("at", at);
    fields.read("turn_deg", turn_deg);
    fields.finish();
    pose = {turned(turn_deg[0], turn_deg[1], turn_deg[2]), {at[0], at[1], at[2]}};
}

void read_hand(Fields fields, int64_t frame, HandTracks& hand) {
    XrPosef pose;
    const Json *grip = fields.find("grip"), *aim = fields.find("aim"), *tracked = fields.find("tracked");
    if (grip) {
        read_pose(Fields(*grip, fields.at("grip")), pose);
        hand.grip.push_back({frame, pose});
    }
    if (aim) read_pose(Fields(*aim, fields.at("aim")), pose);
    if (grip || aim) hand.aim.push_back({frame, pose});
    if (tracked) {
        if (!tracked->is_boolean()) fail(fields.at("tracked"), "true or false is wanted");
        hand.tracked.push_back({frame, tracked->get<bool>()});
    }
    fields.finish();
}

constexpr Named<XrSpaceLocationFlags> kJointFlags[] = {
    {"tracked", kAllFlags},
    {"valid", XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT},
    {"none", 0}};

void read_body_joint(Fields fields, BodyJoint& joint) {
    joint.flags = kAllFlags;
    std::vector<Json> at;
    fields.read("at", at);
    std::string flags = "tracked";
    fields.read("flags", flags);
    joint.flags = named(kJointFlags, flags, fields.at("flags"));
    fields.finish();
    if (at.size() != 3) fail(fields.at("at"), "three numbers are wanted, null for what is no number");
    std::array<float, 3> numbers = {};
    for (size_t i = 0; i < 3; ++i)
        numbers[i] = at[i].is_number() ? at[i].get<float>() : std::numeric_limits<float>::quiet_NaN();
    joint.at = {numbers[0], numbers[1], numbers[2]};
}

void read_body(Fields fields, int64_t frame, BodyTracks& body) {
    if (fields.find("active")) fields.read("active", body.active.emplace_back(Key<bool>{frame, true}).value);
    if (const Json* sure = fields.find("confidence"))
        body.confidence.push_back(
            {frame, sure->is_number() ? sure->get<float>() : std::numeric_limits<float>::quiet_NaN()});
    if (const Json* joints = fields.find("joints"))
        for (const auto& [number, joint] : joints->items()) {
            const std::string place = std::string(fields.at("joints")).append("/").append(number);
            const bool is_number =
                !number.empty() && number.size() < 4 &&
                std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
            if (!is_number) fail(place, "the number of a joint is wanted");
            read_body_joint(Fields(joint, place),
                            body.joints[std::stoi(number)].emplace_back(Key<BodyJoint>{frame, {}}).value);
        }
    fields.finish();
}

void read_inputs(const Json& inputs, const std::string& place, int64_t frame, Script& script) {
    if (!inputs.is_object()) fail(place, "an object is wanted");
    for (const auto& [path, value] : inputs.items()) {
        const std::string at = std::string(place).append("/").append(path);
        if (!path.starts_with("/user/")) fail(at, "a path like /user/hand/right/input/trigger/value is wanted");
        XrVector2f number = {0, 0};
        if (value.is_boolean()) {
            number.x = value.get<bool>() ? 1.0f : 0.0f;
        } else if (value.is_number()) {
            number.x = value.get<float>();
        } else if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number()) {
            number = {value[0].get<float>(), value[1].get<float>()};
            script.inputs[path + "/x"].push_back({frame, {number.x, 0}});
            script.inputs[path + "/y"].push_back({frame, {number.y, 0}});
        } else {
            fail(at, "a boolean, a number or two numbers are wanted");
        }
        script.inputs[path].push_back({frame, number});
    }
}

void read_timeline(const Json& timeline, Script& script) {
    int64_t last = -1;
    for (size_t i = 0; i < timeline.size(); ++i) {
        Fields fields(timeline[i], fmt::format("/timeline/{}", i));
        int64_t frame = 0;
        fields.read("frame", frame);
        if (frame <= last) fail(fields.at("frame"), "keys come in order of their frames, each frame once");
        last = frame;
        if (const Json* head = fields.find("head")) {
            XrPosef pose;
            read_pose(Fields(*head, fields.at("head")), pose);
            script.head.push_back({frame, pose});
        }
        if (const Json* hand = fields.find("left"))
            read_hand(Fields(*hand, fields.at("left")), frame, script.hands[kLeft]);
        if (const Json* hand = fields.find("right"))
            read_hand(Fields(*hand, fields.at("right")), frame, script.hands[kRight]);
        if (const Json* gaze = fields.find("gaze")) {
            script.gaze.tracked.push_back({frame, !gaze->is_null()});
            if (!gaze->is_null())
                read_pose(Fields(*gaze, fields.at("gaze")),
                          script.gaze.pose.emplace_back(Key<XrPosef>{frame, {}}).value);
        }
        if (const Json* body = fields.find("body")) read_body(Fields(*body, fields.at("body")), frame, script.body);
        if (const Json* trackers = fields.find("trackers"))
            for (const auto& [role, tracker] : trackers->items())
                read_pose(Fields(tracker, fields.at("trackers") + "/" + role),
                          script.trackers[role].emplace_back(Key<XrPosef>{frame, {}}).value);
        if (const Json* inputs = fields.find("input")) read_inputs(*inputs, fields.at("input"), frame, script);
        fields.finish();
    }
}

void read_events(const Json& events, Script& script) {
    for (size_t i = 0; i < events.size(); ++i) {
        Fields fields(events[i], fmt::format("/events/{}", i));
        ScriptEvent event;
        fields.read("frame", event.frame);
        fields.read("do", event.what);
        if (std::none_of(std::begin(kEvents), std::end(kEvents), [&](const char* e) { return event.what == e; }))
            fail(fields.at("do"), "unknown event '" + event.what + "'");
        fields.read("frames", event.frames);
        fields.read("periods", event.periods);
        fields.read("calls", event.calls);
        fields.read("times", event.times);
        fields.read("for", event.wait_calls);
        fields.read("restart", event.restart);
        fields.read("hz", event.hz);
        fields.read("profile", event.profile);
        fields.read("worn", event.worn);
        fields.read("says_shift", event.says_shift);
        fields.read("silent", event.silent);
        read_names(fields, "spaces", kSpaces, event.spaces);
        if (const Json* shift = fields.find("shift")) read_pose(Fields(*shift, fields.at("shift")), event.shift);
        fields.finish();
        script.events.push_back(event);
    }
    std::stable_sort(script.events.begin(), script.events.end(),
                     [](const ScriptEvent& a, const ScriptEvent& b) { return a.frame < b.frame; });
}

void read_failures(Fields& fields, Script& script) {
    if (const Json* refuse = fields.find("refuse")) {
        Fields parts(*refuse, fields.at("refuse"));
        std::vector<VkFormat> formats;
        read_names(parts, "formats", kFormats, formats);
        script.refused_formats.insert(formats.begin(), formats.end());
        parts.finish();
    }
    const Json* list = fields.find("fail");
    for (size_t i = 0; list && i < list->size(); ++i) {
        Fields parts((*list)[i], fmt::format("/fail/{}", i));
        ForcedResult forced = {"", XR_ERROR_RUNTIME_FAILURE, 1, 0};
        std::string result = "XR_ERROR_RUNTIME_FAILURE";
        parts.read("function", forced.function);
        if (!has_function(forced.function)) fail(parts.at("function"), "unknown function '" + forced.function + "'");
        parts.read("result", result);
        parts.read("times", forced.times);
        parts.read("skip", forced.skip);
        forced.result = named(kResults, result, parts.at("result"));
        parts.finish();
        script.forced.push_back(forced);
    }
}

void read_fov(Fields& fields, std::array<std::array<float, 4>, 2> fov_deg, XrFovf (&fov)[2]) {
    fields.read("fov_deg", fov_deg);
    const float radians = 3.14159265358979f / 180;
    for (size_t i = 0; i < 2; ++i)
        fov[i] = {fov_deg[i][0] * radians, fov_deg[i][1] * radians, fov_deg[i][2] * radians, fov_deg[i][3] * radians};
}

void read_views(Fields& fields, Script& script) {
    read_fov(fields, {{{-45, 40, 44, -44}, {-40, 45, 44, -44}}}, script.fov);
    if (const Json* narrow = fields.find("narrow_views")) {
        Fields parts(*narrow, fields.at("narrow_views"));
        NarrowViews& views = script.narrow.emplace();
        read_fov(parts, {{{-14, 12, 13, -13}, {-12, 14, 13, -13}}}, views.fov);
        parts.read("width", views.width);
        parts.read("height", views.height);
        parts.finish();
    }
    fields.read("width", script.width);
    fields.read("height", script.height);
    fields.read("eye_distance_m", script.eye_distance_m);
}

// Debian 12's validation layer, which other tests load, refuses the structs of bodies and of user presence: only
// scripts with bodies, or that name the extension, offer them.
std::vector<std::string> default_extensions(const Script& script) {
    std::vector<std::string> names;
    for (const XrExtensionProperties& extension : implemented_extensions()) {
        const std::string name = extension.extensionName;
        if (name == xr::kUserPresenceExtension) continue;
        if (name == XR_FB_PASSTHROUGH_EXTENSION_NAME && !script.has_passthrough) continue;
        if (name == XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME && !script.has_gaze) continue;
        if (name == XR_VARJO_QUAD_VIEWS_EXTENSION_NAME && !script.narrow) continue;
        if (name == XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME && !(script.narrow && script.has_gaze)) continue;
        if (!script.bodies.empty() || name.find("body_tracking") == std::string::npos) names.push_back(name);
    }
    return names;
}

void read_system(Fields& fields, Script& script) {
    fields.read("refresh_hz", script.refresh_hz);
    fields.read("rates_hz", script.rates_hz);
    fields.read("floor_m", script.floor_m);
    fields.read("mask", script.has_mask);
    fields.read("hand_joints", script.has_hand_joints);
    fields.read("passthrough", script.has_passthrough);
    fields.read("gaze", script.has_gaze);
    fields.read("bodies", script.bodies);
    for (const std::string& body : script.bodies)
        if (body != "fb" && body != "full_body" && body != "bd") fail("/bodies", "unknown name '" + body + "'");
    fields.read("profile", script.profile);
    std::string time = "virtual", system = "available";
    fields.read("time", time);
    fields.read("system", system);
    if (time != "virtual" && time != "real") fail("/time", "'virtual' or 'real' is wanted");
    if (system != "available" && system != "unavailable") fail("/system", "'available' or 'unavailable' is wanted");
    script.is_real_time = time == "real";
    script.is_system_available = system == "available";
    script.extensions = default_extensions(script);
    fields.read("extensions", script.extensions);
    for (const std::string& name : script.extensions) {
        const auto& all = implemented_extensions();
        if (std::none_of(all.begin(), all.end(), [&](const auto& known) { return name == known.extensionName; }))
            fail("/extensions", "not implemented here: " + name);
    }
    read_names(fields, "formats", kFormats, script.formats);
    read_names(fields, "blend_modes", kBlendModes, script.blend_modes);
    read_names(fields, "spaces", kSpaces, script.spaces);
}

}  // namespace

std::string name_of_format(int64_t format) {
    for (const Named<VkFormat>& known : kFormats)
        if (known.value == format) return known.name;
    return "";
}

std::string blend_name(XrEnvironmentBlendMode mode) {
    for (const Named<XrEnvironmentBlendMode>& known : kBlendModes)
        if (known.value == mode) return known.name;
    return "";
}

const std::vector<XrExtensionProperties>& implemented_extensions() {
    static const std::vector<XrExtensionProperties> all = [] {
        std::vector<XrExtensionProperties> list;
        auto add = [&](const char* name, uint32_t version) {
            XrExtensionProperties& entry = list.emplace_back(XrExtensionProperties{XR_TYPE_EXTENSION_PROPERTIES});
            std::strncpy(entry.extensionName, name, sizeof entry.extensionName - 1);
            entry.extensionVersion = version;
        };
        add(XR_KHR_VULKAN_ENABLE_EXTENSION_NAME, XR_KHR_vulkan_enable_SPEC_VERSION);
        add(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, XR_KHR_vulkan_enable2_SPEC_VERSION);
        add(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, XR_KHR_composition_layer_depth_SPEC_VERSION);
        add(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, XR_KHR_visibility_mask_SPEC_VERSION);
        add(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, XR_KHR_convert_timespec_time_SPEC_VERSION);
        add(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, XR_FB_display_refresh_rate_SPEC_VERSION);
        add(XR_EXT_HAND_TRACKING_EXTENSION_NAME, XR_EXT_hand_tracking_SPEC_VERSION);
        add("XR_EXT_hand_interaction", 1);
        add(xr::kLocalFloorExtension, 1);
        add(xr::kUserPresenceExtension, 1);
        add(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, XR_EXT_eye_gaze_interaction_SPEC_VERSION);
        add(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME, XR_VARJO_quad_views_SPEC_VERSION);
        add(XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME, XR_VARJO_foveated_rendering_SPEC_VERSION);
        add(XR_FB_PASSTHROUGH_EXTENSION_NAME, XR_FB_passthrough_SPEC_VERSION);
        for (const char* controllers :
             {"XR_FB_touch_controller_pro", "XR_META_touch_controller_plus", "XR_BD_controller_interaction",
              "XR_HTC_vive_focus3_controller_interaction", "XR_EXT_hp_mixed_reality_controller",
              "XR_ML_ml2_controller_interaction", "XR_KHR_generic_controller"})
            add(controllers, 1);
        add(XR_MSFT_HAND_INTERACTION_EXTENSION_NAME, XR_MSFT_hand_interaction_SPEC_VERSION);
        add(XR_FB_BODY_TRACKING_EXTENSION_NAME, XR_FB_body_tracking_SPEC_VERSION);
        add(XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME, XR_META_body_tracking_full_body_SPEC_VERSION);
        add(XR_BD_BODY_TRACKING_EXTENSION_NAME, XR_BD_body_tracking_SPEC_VERSION);
        add(XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME, XR_HTCX_vive_tracker_interaction_SPEC_VERSION);
        add(XR_EXT_DEBUG_UTILS_EXTENSION_NAME, XR_EXT_debug_utils_SPEC_VERSION);
        return list;
    }();
    return all;
}

Script parse_script(const std::string& text) {
    Script script;
    for (const Named<VkFormat>& format : kFormats)
        if (format.value != VK_FORMAT_B8G8R8A8_UNORM) script.formats.push_back(format.value);

    Json json = Json::object();
    if (!text.empty()) {
        try {
            json = Json::parse(text);
        } catch (const Json::exception& error) {
            fail("JSON", error.what());
        }
    }
    Fields fields(json, "");
    read_views(fields, script);
    read_system(fields, script);
    if (const Json* timeline = fields.find("timeline")) read_timeline(*timeline, script);
    if (const Json* events = fields.find("events")) read_events(*events, script);
    read_failures(fields, script);
    fields.read("save_frames", script.save_frames);
    fields.read("save_every", script.save_every);
    fields.read("end_frame", script.end_frame);
    fields.finish();
    return script;
}

XrPosef pose_at(const Track<XrPosef>& track, double frame, const XrPosef& fallback) {
    if (track.empty()) return fallback;
    if (frame <= static_cast<double>(track.front().frame)) return track.front().value;
    for (size_t i = 1; i < track.size(); ++i) {
        const auto begin = static_cast<double>(track[i - 1].frame), end = static_cast<double>(track[i].frame);
        if (frame < end)
            return between(track[i - 1].value, track[i].value, static_cast<float>((frame - begin) / (end - begin)));
    }
    return track.back().value;
}

}  // namespace neuvv::xr_runtime
