// The OpenXR runtime of this machine, its headset, and what they offer.
#pragma once

#include <string>
#include <vector>

#include "gpu/device.h"
#include "xr/openxr.h"

namespace neuvv::xr {

// An extension of OpenXR that is used where the runtime offers it.
struct OptionalExtension {
    const char* name;
    const char* benefit;         // what the program does with the extension, for people
    const char* fallback;        // what it does without
    bool is_controller = false;  // it only defines a controller, which is the benefit
};
// All optional extensions. Besides these, one of the extensions for Vulkan is required.
std::vector<OptionalExtension> optional_extensions();

constexpr uint32_t kEyes = 2;
// Some headsets show two images to each eye: a wide one and, over its centre or where the eye looks, a narrow one with
// more pixels for each degree (quad views). The order of views is left, right, narrow left, narrow right.
constexpr uint32_t kMaxViews = 4;
enum class ViewChoice {
    kAsOffered,  // four views, where runtime and headset have them
    kStereo      // two
};

// An instance of the runtime, and its headset. It must outlive all other objects of this module.
class Runtime {
  public:
    // Throws RuntimeFailure where there is no runtime, no headset, no support of Vulkan or no stereo; its message is
    // one line that says what to start or to plug in.
    explicit Runtime(ViewChoice choice = ViewChoice::kAsOffered);

    XrInstance instance() const { return instance_.get(); }
    XrSystemId system() const { return system_; }
    // Whether the runtime offers an extension. Offered extensions that this module knows are enabled.
    bool has(const char* extension) const;
    // The same, but false, too, where this headset lacks what the extension is about (hands, bodies).
    bool supports(const char* extension) const;
    template <typename Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(find_function(name));
    }
    XrPath path(const char* text) const;
    std::string text_of(XrPath path) const;

    const std::string& name() const { return name_; }          // "Monado 21.0.0"
    const std::string& headset() const { return headset_; }    // "Simulated HMD"
    bool tracks_position() const { return tracks_position_; }  // else only the head's orientation is tracked
    uint32_t view_count() const { return static_cast<uint32_t>(views_.size()); }  // kEyes or kMaxViews
    bool has_narrow_views() const { return view_count() > kEyes; }
    // Whether the narrow views are where the eyes look, while these are tracked (XR_VARJO_foveated_rendering).
    bool narrow_views_follow_gaze() const { return !gaze_views_.empty(); }
    // The size in pixels that the runtime recommends for a view's image. While narrow views follow the gaze, it may be
    // another one. It is at most max_image_size().
    VkExtent2D recommended_size(uint32_t view, bool follows_gaze = false) const;
    // The size of images that have room for each view at any time, and the largest size that the runtime takes for all.
    VkExtent2D image_size() const;
    VkExtent2D max_image_size() const;
    // At least one; the runtime prefers the first.
    const std::vector<XrEnvironmentBlendMode>& blend_modes() const { return blend_modes_; }
    XrViewConfigurationType view_configuration() const { return view_configuration_; }

    // The Vulkan extensions that the runtime requires, and the calls with which it creates instance and device, for the
    // constructor of gpu::Device. Both refer to this object, which must outlive the Device. device_extensions() throws
    // RuntimeFailure where the runtime requires a newer version of Vulkan than 1.3.
    gpu::DeviceExtensions device_extensions();
    gpu::DeviceMaker device_maker() const;

  private:
    PFN_xrVoidFunction find_function(const char* name) const;
    void create_instance();
    void find_headset();
    void find_properties();
    void find_views(ViewChoice choice);
    std::vector<XrViewConfigurationView> views_of(XrViewConfigurationType type, bool follows_gaze) const;
    void check_vulkan_version() const;

    std::vector<std::string> offered_;
    std::vector<std::string> vulkan_extension_names_;  // what XR_KHR_vulkan_enable requires; owns the names
    XrOwnedInstance instance_;
    XrSystemId system_ = XR_NULL_SYSTEM_ID;
    std::string name_, headset_;
    bool tracks_position_ = false;
    std::vector<std::string> lacking_;  // extensions that the runtime offers and the headset has no use for
    XrViewConfigurationType view_configuration_ = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    std::vector<XrViewConfigurationView> views_, gaze_views_;  // the latter while narrow views follow the gaze
    std::vector<XrEnvironmentBlendMode> blend_modes_;
};

const char* blend_mode_name(XrEnvironmentBlendMode mode);

}  // namespace neuvv::xr
