#include "xr/runtime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "base/platform.h"
#include "xr/bindings.h"
#include "xr/body_tracking_types.h"
#include "xr/newer_types.h"

namespace neuvv::xr {

namespace {

constexpr const char* kStart =
    "start your headset's runtime (SteamVR, Monado's monado-service, Meta Link, Windows Mixed Reality)";

std::string version_text(XrVersion version) {
    return fmt::format("{}.{}.{}", XR_VERSION_MAJOR(version), XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
}

std::vector<std::string> offered_extensions() {
    try {
        std::vector<std::string> names;
        for (const auto& one : enumerate("xrEnumerateInstanceExtensionProperties", "OpenXR",
                                         XrExtensionProperties{XR_TYPE_EXTENSION_PROPERTIES},
                                         [](uint32_t capacity, uint32_t*count, XrExtensionProperties*all) {
                                             return xrEnumerateInstanceExtensionProperties(nullptr, capacity, count,
                                                                                           all);
                                         }))
            names.emplace_back(one.extensionName);
        return names;
    } catch (const XrFailure& failure) {
        const char* manifest = std::getenv("XR_RUNTIME_JSON");
        std::error_code ignored;
        if (manifest && *manifest && !std::filesystem::exists(manifest, ignored))
            throw RuntimeFailure(fmt::format("XR_RUNTIME_JSON names {}, which is not there", manifest));
        throw RuntimeFailure(
            fmt::format("no OpenXR runtime answers ({}): {}; XR_RUNTIME_JSON names another one's manifest",
                        result_name(failure.result), kStart));
    }
}

}  // namespace

std::vector<OptionalExtension> optional_extensions() {
    std::vector<OptionalExtension> all{
        {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, "depth goes to the compositor, which moves late images better",
         "images go without their depth"},
        {XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, "what no lens shows is not drawn", "all of each image is drawn"},
        {XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, "the refresh rate can be chosen",
         "the refresh rate is the runtime's"},
        {kLocalFloorExtension, "the floor is known without a play area",
         "the floor is taken from the play area, or guessed"},
        {XR_EXT_HAND_TRACKING_EXTENSION_NAME, "bare hands are seen, and pinches select", "controllers alone"},
        {kHandInteraction, "bare hands point, select and grab", "controllers alone"},
        {XR_MSFT_HAND_INTERACTION_EXTENSION_NAME, "the same by its older name", "not needed beside the one above"},
        {XR_FB_BODY_TRACKING_EXTENSION_NAME, "the upper body is tracked", "the body is taken from another source"},
        {XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME, "legs come with the upper body",
         "the body is taken from another source"},
        {XR_BD_BODY_TRACKING_EXTENSION_NAME, "the whole body is tracked", "the body is taken from another source"},
        {XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME, "trackers that are worn say where joints are",
         "the body is taken from another source"},
        {XR_FB_PASSTHROUGH_EXTENSION_NAME, "your own room can be seen",
         "your own room is seen only by a blend mode, see above"},
        {XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, "the inset is where you look",
         "the inset is in the centre of each eye's image"},
        {XR_VARJO_QUAD_VIEWS_EXTENSION_NAME, "each eye has a narrow view with more pixels over its wide one",
         "each eye has one view"},
        {XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME, "the narrow views are where you look",
         "narrow views, where there are any, are in the centre"},
        {kUserPresenceExtension, "the stage pauses while nobody wears the headset", "the stage goes on"},
    };
    for (const ControllerProfile& profile : controller_profiles()) {
        const auto is_it = [&](const OptionalExtension& one) { return std::strcmp(one.name, profile.extension) == 0; };
        if (profile.extension && std::none_of(all.begin(), all.end(), is_it))
            all.push_back(
                {profile.extension, profile.title, "the runtime translates bindings of other controllers", true});
    }
    return all;
}

const char* blend_mode_name(XrEnvironmentBlendMode mode) {
    switch (mode) {
        case XR_ENVIRONMENT_BLEND_MODE_OPAQUE:
            return "opaque";
        case XR_ENVIRONMENT_BLEND_MODE_ADDITIVE:
            return "additive";
        case XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND:
            return "alpha blend";
        default:
            return "unknown";
    }
}

// XR_LOADER_DEBUG keeps the loader from printing: its lines say less than the messages of this program.
Runtime::Runtime(ViewChoice choice) {
    set_environment_default("XR_LOADER_DEBUG", "none");
    offered_ = offered_extensions();
    create_instance();
    find_headset();
    find_views(choice);
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME) || has(XR_KHR_VULKAN_ENABLE_EXTENSION_NAME)) return;
    throw RuntimeFailure(fmt::format("{} shows no images made by Vulkan; start a runtime that does", name_));
}

bool Runtime::has(const char* extension) const {
    return std::find(offered_.begin(), offered_.end(), extension) != offered_.end();
}

bool Runtime::supports(const char* extension) const {
    return has(extension) && std::find(lacking_.begin(), lacking_.end(), extension) == lacking_.end();
}

void Runtime::create_instance() {
    std::vector<const char*> enabled;
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME))
        enabled.push_back(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME);
    else if (has(XR_KHR_VULKAN_ENABLE_EXTENSION_NAME))
        enabled.push_back(XR_KHR_VULKAN_ENABLE_EXTENSION_NAME);
    for (const OptionalExtension& one : optional_extensions())
        if (has(one.name)) enabled.push_back(one.name);
    XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
    std::strcpy(info.applicationInfo.applicationName, "NeuVV");
    std::strcpy(info.applicationInfo.engineName, "NeuVV");
    info.applicationInfo.applicationVersion = info.applicationInfo.engineVersion = 1;
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
    info.enabledExtensionCount = static_cast<uint32_t>(enabled.size());
    info.enabledExtensionNames = enabled.data();
    const XrResult result = xrCreateInstance(&info, instance_.out());
    if (XR_FAILED(result))
        throw RuntimeFailure(fmt::format("the OpenXR runtime does not start ({}): {}", result_name(result), kStart));
    XrInstanceProperties properties{XR_TYPE_INSTANCE_PROPERTIES};
    check(xrGetInstanceProperties(instance(), &properties), "xrGetInstanceProperties", "runtime");
    name_ = fmt::format("{} {}", properties.runtimeName, version_text(properties.runtimeVersion));
}

void Runtime::find_headset() {
    const XrSystemGetInfo info{XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    const XrResult result = xrGetSystem(instance(), &info, &system_);
    if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE || result == XR_ERROR_FORM_FACTOR_UNSUPPORTED)
        throw RuntimeFailure(fmt::format("{} runs, but has no headset now: plug it in and switch it on", name_));
    check(result, "xrGetSystem", name_);
    find_properties();
}

void Runtime::find_properties() {
    XrSystemProperties properties{XR_TYPE_SYSTEM_PROPERTIES};
    check(xrGetSystemProperties(instance(), system_, &properties), "xrGetSystemProperties", name_);
    headset_ = properties.systemName;
    tracks_position_ = properties.trackingProperties.positionTracking;
    // Each extension is asked for alone, as a layer that does not know one of the structs refuses the call.
    const auto find = [&](const char* extension, auto answer, XrBool32 decltype(answer)::*has_it) {
        if (!has(extension)) return;
        properties.next = &answer;
        const XrResult result = xrGetSystemProperties(instance(), system_, &properties);
        if (!succeeded(result, "xrGetSystemProperties", name_) || !(answer.*has_it)) lacking_.emplace_back(extension);
    };
    find(XR_EXT_HAND_TRACKING_EXTENSION_NAME,
         XrSystemHandTrackingPropertiesEXT{XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT, nullptr, XR_FALSE},
         &XrSystemHandTrackingPropertiesEXT::supportsHandTracking);
    find(kUserPresenceExtension, XrSystemUserPresencePropertiesEXT{kUserPresenceProperties, nullptr, XR_FALSE},
         &XrSystemUserPresencePropertiesEXT::supportsUserPresence);
    find(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
         XrSystemEyeGazeInteractionPropertiesEXT{XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT, nullptr, XR_FALSE},
         &XrSystemEyeGazeInteractionPropertiesEXT::supportsEyeGazeInteraction);
    find(
        XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME,
        XrSystemFoveatedRenderingPropertiesVARJO{XR_TYPE_SYSTEM_FOVEATED_RENDERING_PROPERTIES_VARJO, nullptr, XR_FALSE},
        &XrSystemFoveatedRenderingPropertiesVARJO::supportsFoveatedRendering);
    find(XR_FB_PASSTHROUGH_EXTENSION_NAME,
         XrSystemPassthroughPropertiesFB{XR_TYPE_SYSTEM_PASSTHROUGH_PROPERTIES_FB, nullptr, XR_FALSE},
         &XrSystemPassthroughPropertiesFB::supportsPassthrough);
    find(XR_FB_BODY_TRACKING_EXTENSION_NAME,
         XrSystemBodyTrackingPropertiesFB{XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_FB, nullptr, XR_FALSE},
         &XrSystemBodyTrackingPropertiesFB::supportsBodyTracking);
    find(XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME,
         XrSystemPropertiesBodyTrackingFullBodyMETA{XR_TYPE_SYSTEM_PROPERTIES_BODY_TRACKING_FULL_BODY_META, nullptr,
                                                    XR_FALSE},
         &XrSystemPropertiesBodyTrackingFullBodyMETA::supportsFullBodyTracking);
    find(XR_BD_BODY_TRACKING_EXTENSION_NAME,
         XrSystemBodyTrackingPropertiesBD{XR_TYPE_SYSTEM_BODY_TRACKING_PROPERTIES_BD, nullptr, XR_FALSE},
         &XrSystemBodyTrackingPropertiesBD::supportsBodyTracking);
}

std::vector<XrViewConfigurationView> Runtime::views_of(XrViewConfigurationType type, bool follows_gaze) const {
    XrFoveatedViewConfigurationViewVARJO foveated{XR_TYPE_FOVEATED_VIEW_CONFIGURATION_VIEW_VARJO, nullptr, XR_TRUE};
    XrViewConfigurationView blank{XR_TYPE_VIEW_CONFIGURATION_VIEW};
    if (follows_gaze) blank.next = &foveated;  // one for all views, which only read it
    auto views =
        enumerate("xrEnumerateViewConfigurationViews", headset_, blank,
                  [&](uint32_t capacity, uint32_t* count, XrViewConfigurationView* all) {
                      return xrEnumerateViewConfigurationViews(instance(), system_, type, capacity, count, all);
                  });
    for (XrViewConfigurationView& view : views) view.next = nullptr;
    return views;
}

// OpenXR 1.1 has the quad views of XR_VARJO_quad_views as stereo with a foveated inset, with the same number.
void Runtime::find_views(ViewChoice choice) {
    const auto kinds = enumerate("xrEnumerateViewConfigurations", headset_, XrViewConfigurationType{},
                                 [&](uint32_t capacity, uint32_t* count, XrViewConfigurationType* all) {
                                     return xrEnumerateViewConfigurations(instance(), system_, capacity, count, all);
                                 });
    const auto is_offered = [&](XrViewConfigurationType type) {
        return std::find(kinds.begin(), kinds.end(), type) != kinds.end();
    };
    constexpr XrViewConfigurationType kQuad = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO;
    if (!is_offered(kQuad)) lacking_.emplace_back(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME);
    if (choice == ViewChoice::kAsOffered && is_offered(kQuad)) views_ = views_of(kQuad, false);
    if (views_.size() == kMaxViews) {
        view_configuration_ = kQuad;
        if (supports(XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME)) gaze_views_ = views_of(kQuad, true);
        if (gaze_views_.size() != kMaxViews) gaze_views_.clear();
    } else {
        if (!is_offered(view_configuration()))
            throw RuntimeFailure(fmt::format("\"{}\" of {} does not show two eyes", headset_, name_));
        views_ = views_of(view_configuration(), false);
        if (views_.size() != kEyes)
            throw RuntimeFailure(fmt::format("\"{}\" of {} has {} views for two eyes", headset_, name_, views_.size()));
    }
    blend_modes_ = enumerate("xrEnumerateEnvironmentBlendModes", headset_, XrEnvironmentBlendMode{},
                             [&](uint32_t capacity, uint32_t* count, XrEnvironmentBlendMode* all) {
                                 return xrEnumerateEnvironmentBlendModes(instance(), system_, view_configuration(),
                                                                         capacity, count, all);
                             });
    if (blend_modes_.empty()) throw RuntimeFailure(fmt::format("\"{}\" of {} shows no image", headset_, name_));
}

VkExtent2D Runtime::recommended_size(uint32_t view, bool follows_gaze) const {
    const VkExtent2D max = max_image_size();
    const XrViewConfigurationView& one = (follows_gaze && narrow_views_follow_gaze() ? gaze_views_ : views_)[view];
    return {std::min(one.recommendedImageRectWidth, max.width), std::min(one.recommendedImageRectHeight, max.height)};
}

VkExtent2D Runtime::image_size() const {
    VkExtent2D size{};
    for (uint32_t view = 0; view < view_count(); ++view)
        for (const bool follows_gaze : {false, true}) {
            const VkExtent2D one = recommended_size(view, follows_gaze);
            size = {std::max(size.width, one.width), std::max(size.height, one.height)};
        }
    return size;
}

VkExtent2D Runtime::max_image_size() const {
    VkExtent2D size{UINT32_MAX, UINT32_MAX};
    for (const auto* views : {&views_, &gaze_views_})
        for (const XrViewConfigurationView& one : *views)
            size = {std::min(size.width, one.maxImageRectWidth), std::min(size.height, one.maxImageRectHeight)};
    return size;
}

PFN_xrVoidFunction Runtime::find_function(const char* name) const {
    PFN_xrVoidFunction found = nullptr;
    check(xrGetInstanceProcAddr(instance(), name, &found), "xrGetInstanceProcAddr", name);
    return found;
}

XrPath Runtime::path(const char* text) const {
    XrPath path = XR_NULL_PATH;
    check(xrStringToPath(instance(), text, &path), "xrStringToPath", text);
    return path;
}

std::string Runtime::text_of(XrPath path) const {
    if (path == XR_NULL_PATH) return {};
    const auto text = enumerate("xrPathToString", name_, char{}, [&](uint32_t capacity, uint32_t* count, char* all) {
        return xrPathToString(instance(), path, capacity, count, all);
    });
    return text.data();
}

// OpenXR also demands that the requirements are queried before a session is created.
void Runtime::check_vulkan_version() const {
    XrGraphicsRequirementsVulkanKHR needs{XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN_KHR};
    const bool second = has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME);
    const char* call = second ? "xrGetVulkanGraphicsRequirements2KHR" : "xrGetVulkanGraphicsRequirementsKHR";
    check(function<PFN_xrGetVulkanGraphicsRequirementsKHR>(call)(instance(), system_, &needs), call, name_);
    if (needs.minApiVersionSupported > XR_MAKE_VERSION(1, 3, XR_VERSION_PATCH(~0ull)))
        throw RuntimeFailure(fmt::format("{} wants Vulkan {} at least, this program uses 1.3", name_,
                                         version_text(needs.minApiVersionSupported)));
}

gpu::DeviceExtensions Runtime::device_extensions() {
    check_vulkan_version();
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) return {};
    const auto names = [&](const char* call) {
        const auto get = function<PFN_xrGetVulkanInstanceExtensionsKHR>(call);
        const auto text = enumerate(call, name_, char{}, [&](uint32_t capacity, uint32_t* count, char* all) {
            return get(instance(), system_, capacity, count, all);
        });
        std::istringstream words(text.empty() ? "" : text.data());
        return std::vector<std::string>{std::istream_iterator<std::string>(words), {}};
    };
    vulkan_extension_names_ = names("xrGetVulkanInstanceExtensionsKHR");
    const size_t first_of_device = vulkan_extension_names_.size();
    for (std::string& name : names("xrGetVulkanDeviceExtensionsKHR"))
        vulkan_extension_names_.push_back(std::move(name));
    gpu::DeviceExtensions extensions;
    for (size_t i = 0; i < vulkan_extension_names_.size(); ++i)
        (i < first_of_device ? extensions.instance : extensions.device).push_back(vulkan_extension_names_[i].c_str());
    return extensions;
}

gpu::DeviceMaker Runtime::device_maker() const {
    gpu::DeviceMaker maker;
    if (!has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) {
        maker.choose_physical = [this](VkInstance vulkan) {
            VkPhysicalDevice physical = VK_NULL_HANDLE;
            check(function<PFN_xrGetVulkanGraphicsDeviceKHR>("xrGetVulkanGraphicsDeviceKHR")(instance(), system_,
                                                                                             vulkan, &physical),
                  "xrGetVulkanGraphicsDeviceKHR", name_);
            return physical;
        };
        return maker;
    }
    maker.create_instance = [this](const VkInstanceCreateInfo& vulkan, VkInstance* made) {
        XrVulkanInstanceCreateInfoKHR info{XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR};
        info.systemId = system_;
        info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
        info.vulkanCreateInfo = &vulkan;
        VkResult result = VK_SUCCESS;
        check(function<PFN_xrCreateVulkanInstanceKHR>("xrCreateVulkanInstanceKHR")(instance(), &info, made, &result),
              "xrCreateVulkanInstanceKHR", name_);
        return result;
    };
    maker.choose_physical = [this](VkInstance vulkan) {
        const XrVulkanGraphicsDeviceGetInfoKHR info{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, nullptr, system_,
                                                    vulkan};
        VkPhysicalDevice physical = VK_NULL_HANDLE;
        check(
            function<PFN_xrGetVulkanGraphicsDevice2KHR>("xrGetVulkanGraphicsDevice2KHR")(instance(), &info, &physical),
            "xrGetVulkanGraphicsDevice2KHR", name_);
        return physical;
    };
    maker.create_device = [this](VkPhysicalDevice physical, const VkDeviceCreateInfo& vulkan, VkDevice* made) {
        XrVulkanDeviceCreateInfoKHR info{XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR};
        info.systemId = system_;
        info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
        info.vulkanPhysicalDevice = physical;
        info.vulkanCreateInfo = &vulkan;
        VkResult result = VK_SUCCESS;
        check(function<PFN_xrCreateVulkanDeviceKHR>("xrCreateVulkanDeviceKHR")(instance(), &info, made, &result),
              "xrCreateVulkanDeviceKHR", name_);
        return result;
    };
    return maker;
}

}  // namespace neuvv::xr
