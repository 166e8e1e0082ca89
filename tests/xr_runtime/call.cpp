#include "call.h"

#include "pose.h"

namespace neuvv::xr_runtime {

namespace {

// Which structs may be chained to which, and the extensions of which one must be enabled.
struct ChainRule {
    XrStructureType base, chained;
    const char* extension;
    const char* other_extension;
};
constexpr ChainRule kChainRules[] = {
    {XR_TYPE_SPACE_LOCATION, XR_TYPE_SPACE_VELOCITY, nullptr, nullptr},
    {XR_TYPE_INSTANCE_CREATE_INFO, XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, XR_EXT_DEBUG_UTILS_EXTENSION_NAME,
     nullptr},
    {XR_TYPE_SESSION_CREATE_INFO, XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR, XR_KHR_VULKAN_ENABLE_EXTENSION_NAME,
     XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT, XR_EXT_HAND_TRACKING_EXTENSION_NAME,
     nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT,
     XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_PASSTHROUGH_PROPERTIES_FB, XR_FB_PASSTHROUGH_EXTENSION_NAME, nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_FOVEATED_RENDERING_PROPERTIES_VARJO,
     XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME, nullptr},
    {XR_TYPE_VIEW_CONFIGURATION_VIEW, XR_TYPE_FOVEATED_VIEW_CONFIGURATION_VIEW_VARJO,
     XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME, nullptr},
    {XR_TYPE_VIEW_LOCATE_INFO, XR_TYPE_VIEW_LOCATE_FOVEATED_RENDERING_VARJO, XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME,
     nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, xr::kUserPresenceProperties, xr::kUserPresenceExtension, nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_FB, XR_FB_BODY_TRACKING_EXTENSION_NAME,
     nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_PROPERTIES_BODY_TRACKING_FULL_BODY_META,
     XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME, nullptr},
    {XR_TYPE_SYSTEM_PROPERTIES, XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_BD, XR_BD_BODY_TRACKING_EXTENSION_NAME,
     nullptr},
    {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR,
     XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, nullptr},
    {XR_TYPE_HAND_JOINT_LOCATIONS_EXT, XR_TYPE_HAND_JOINT_VELOCITIES_EXT, XR_EXT_HAND_TRACKING_EXTENSION_NAME, nullptr},
};

const ChainRule* rule_of(XrStructureType base, XrStructureType chained) {
    for (const ChainRule& rule : kChainRules)
        if (rule.base == base && rule.chained == chained) return &rule;
    return nullptr;
}

void check_link(XrStructureType base, const char* name, const XrBaseInStructure& link) {
    const ChainRule* rule = rule_of(base, link.type);
    if (!rule) {
        warn("next-chain", fmt::format("{} in the next chain of {} is none that this runtime offers there; ignored",
                                       name_of(link.type), name));
        return;
    }
    const auto& instance = runtime().instance;
    const bool has_extension = !rule->extension || !instance || instance->has(rule->extension) ||
                               (rule->other_extension && instance->has(rule->other_extension));
    if (!has_extension)
        violate("extension",
                fmt::format("{} is chained to {}, but {} is not enabled", name_of(link.type), name, rule->extension));
}

Finding finding_of(Rule rule, const std::string& text) {
    const Call* call = current_call();
    return {runtime().progress.frame(), call ? call->function : "", std::string(rule.name), text, 1};
}

}  // namespace

Call*& current_call() {
    thread_local Call* call = nullptr;
    return call;
}

void violate(Rule rule, const std::string& text) {
    runtime().report.add_violation(finding_of(rule, text));
}

void warn(Rule rule, const std::string& text) {
    runtime().report.add_warning(finding_of(rule, text));
}

void refuse(XrResult result, Rule rule, const std::string& text) {
    violate(rule, fmt::format("{} ({})", text, name_of(result)));
    throw Refusal{result};
}

void report_own_failure(const std::string& text) {
    fmt::print(stderr, "xr-runtime: {}: {}\n", current_call()->function, text);
    warn("runtime", "this runtime itself failed: " + text);
}

std::optional<XrResult> scripted_result(const char* function) {
    const std::string name = function;
    Instance* instance = runtime().instance.get();
    // The script is read here, so that it can force the result of xrCreateInstance, too.
    if (!instance && name == "xrCreateInstance") load_configuration();
    // On a lost instance, destroying still works, and so does what the loader calls before it creates an instance.
    const bool always_works = name.starts_with("xrDestroy") || name == "xrCreateInstance" ||
                              name == "xrGetInstanceProcAddr" || name.starts_with("xrEnumerateInstanceExtension");
    if (instance && !always_works) {
        if (instance->calls_until_loss >= 0 && instance->calls_until_loss-- == 0) instance->is_lost = true;
        if (instance->is_lost) return XR_ERROR_INSTANCE_LOST;
    }
    for (ForcedResult& forced : runtime().script.forced) {
        if (forced.function != name || forced.times == 0) continue;
        if (forced.skip-- > 0) continue;
        forced.skip = 0;
        --forced.times;
        return forced.result;
    }
    return std::nullopt;
}

void refuse_handle(uint64_t handle, Kind kind, const char* name) {
    const auto wanted = static_cast<uint8_t>(kind);
    const uint64_t serial = handle & ((uint64_t{1} << kKindShift) - 1);
    std::string text = fmt::format("no {} has the handle {:#x}", name, handle);
    if (handle == 0)
        text = fmt::format("the {} must not be XR_NULL_HANDLE", name);
    else if (runtime().objects.contains(handle))
        text = fmt::format("the handle {:#x} is of another kind than {}", handle, name);
    else if (handle >> kKindShift == wanted && serial < runtime().next_serial)
        text = fmt::format("the {} was destroyed before, or its parent was", name);
    refuse(XR_ERROR_HANDLE_INVALID, "handle", text);
}

std::string name_of(XrStructureType type) {
#define NEUVV_XR_CASE(name, value) \
    case name:                     \
        return #name;
    switch (type) { XR_LIST_ENUM_XrStructureType(NEUVV_XR_CASE) default : break; }
    return fmt::format("XR_UNKNOWN_STRUCTURE_TYPE_{}", static_cast<int>(type));
}

std::string name_of(XrResult result) {
    switch (result) { XR_LIST_ENUM_XrResult(NEUVV_XR_CASE) default : break; }
#undef NEUVV_XR_CASE
    return fmt::format("XR_UNKNOWN_{}_{}", result < 0 ? "FAILURE" : "SUCCESS", static_cast<int>(result));
}

void check_chain(XrStructureType expected, const char* name, const void* structure) {
    const auto* base = static_cast<const XrBaseInStructure*>(structure);
    require(base->type == expected, XR_ERROR_VALIDATION_FAILURE, "type",
            fmt::format("{}.type must be {}, not {}", name, name_of(expected), name_of(base->type)));
    std::set<XrStructureType> seen;
    for (const XrBaseInStructure* link = base->next; link; link = link->next) {
        require(seen.insert(link->type).second, XR_ERROR_VALIDATION_FAILURE, "next-chain",
                fmt::format("{} is twice in the next chain of {}", name_of(link->type), name));
        check_link(expected, name, *link);
    }
}

bool wants_values(uint32_t capacity, uint32_t* count, const void* values, size_t available) {
    check_pointer(count, "the count of a two-call function");
    *count = static_cast<uint32_t>(available);
    if (capacity == 0) return false;
    check_pointer(values, "an array with a capacity above 0");
    if (capacity < available) {
        warn("two-call", fmt::format("a capacity of {} for {} values", capacity, available));
        decline(XR_ERROR_SIZE_INSUFFICIENT);
    }
    return true;
}

XrResult give_text(uint32_t capacity, uint32_t* count, char* out, const std::string& text) {
    if (wants_values(capacity, count, out, text.size() + 1)) std::memcpy(out, text.c_str(), text.size() + 1);
    return XR_SUCCESS;
}

Instance& instance_of(XrInstance handle) {
    return *shared<Instance>(handle);
}

void check_system(const Instance& instance, XrSystemId system) {
    require(instance.has_system && system == kSystem, XR_ERROR_SYSTEM_INVALID, "system",
            "the XrSystemId is none that xrGetSystem gave to this instance");
}

void check_view_configuration(XrViewConfigurationType type) {
    const bool is_quad = type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO &&
                         runtime().instance->has(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME);
    const bool is_known =
        type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO || type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO || is_quad;
    require(is_known, XR_ERROR_VALIDATION_FAILURE, "view-configuration",
            fmt::format("{} is no XrViewConfigurationType of core OpenXR or of an enabled extension",
                        static_cast<int>(type)));
    const auto offered = offered_view_configurations();
    require(std::find(offered.begin(), offered.end(), type) != offered.end(),
            XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "view-configuration",
            "xrEnumerateViewConfigurations does not name this view configuration");
}

std::vector<XrViewConfigurationType> offered_view_configurations() {
    std::vector<XrViewConfigurationType> types = {XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    if (runtime().script.narrow && runtime().instance->has(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME))
        types.insert(types.begin(), XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO);
    return types;
}

uint32_t view_count(XrViewConfigurationType type) {
    return type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO ? 4 : 2;
}

void check_time(XrTime time) {
    require(time > 0, XR_ERROR_TIME_INVALID, "time", fmt::format("an XrTime is positive, unlike {}", time));
}

void check_pose(const XrPosef& pose, const char* name) {
    const XrQuaternionf& q = pose.orientation;
    require(is_valid(pose), XR_ERROR_POSE_INVALID, "pose",
            fmt::format("{} must have a unit quaternion and a finite position, not ({}, {}, {}, {})", name, q.x, q.y,
                        q.z, q.w));
}

const std::string& text_of(XrPath path) {
    static const std::string kNone;
    const Instance* instance = runtime().instance.get();
    const bool is_known =
        instance && path >= instance->first_path && path - instance->first_path < instance->paths.size();
    require(is_known, XR_ERROR_PATH_INVALID, "path", fmt::format("the XrPath {} is none of this instance's", path));
    return is_known ? instance->paths[path - instance->first_path] : kNone;
}

XrPath path_of(const std::string& text) {
    Instance& instance = *runtime().instance;
    auto& paths = instance.paths;
    auto found = std::find(paths.begin(), paths.end(), text);
    if (found == paths.end()) found = paths.insert(paths.end(), text);
    return instance.first_path + static_cast<XrPath>(found - paths.begin());
}

}  // namespace neuvv::xr_runtime
