// The OpenXR runtime of this machine, the headset behind it, and what they offer.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "xr/openxr.h"

namespace neuvv::xr {

// An extension of OpenXR that is used where there is one; `without` says what is done where there is none.
struct OptionalExtension {
    const char* name;
    const char* brings;
    const char* without;
};
// All of them; a Vulkan one is needed besides.
std::vector<OptionalExtension> optional_extensions();

constexpr uint32_t kEyes = 2;

// One instance of the runtime, and its headset. Everything else of this module lives shorter.
class Runtime {
  public:
    // Throws RuntimeFailure, in a line that says what to start or to plug in, where there is no runtime, no headset, no
    // Vulkan or no stereo.
    Runtime();

    XrInstance instance() const { return instance_.get(); }
    XrSystemId system() const { return system_; }
    // Whether an extension is offered, and so is in use.
    bool has(const char* extension) const;
    template <typename Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(find_function(name));
    }
    XrPath path(const char* text) const;
    std::string text_of(XrPath path) const;

    const std::string& name() const { return name_; }          // "Monado 21.0.0"
    const std::string& headset() const { return headset_; }    // "Simulated HMD"
    bool tracks_position() const { return tracks_position_; }  // else it only turns
    bool tracks_hands() const { return tracks_hands_; }        // joints, by XR_EXT_hand_tracking
    const std::array<XrViewConfigurationView, kEyes>& views() const { return views_; }
    // Pixels that it recommends for an eye, the larger of both; and the most that it takes.
    VkExtent2D eye_size() const;
    VkExtent2D most_eye_size() const;
    XrEnvironmentBlendMode blend_mode() const { return blend_modes_[0]; }  // the one that it prefers
    const std::vector<XrEnvironmentBlendMode>& blend_modes() const { return blend_modes_; }
    XrViewConfigurationType view_configuration() const { return XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO; }

    // Vulkan as the runtime wants it: for the constructor of Device. Both use this object, which must outlive the
    // Device.
    gpu::DeviceExtensions device_extensions();
    gpu::DeviceMaker device_maker() const;

  private:
    PFN_xrVoidFunction find_function(const char* name) const;
    void make_instance();
    void find_headset();
    void find_views();
    void expect_vulkan_version() const;

    std::vector<std::string> offered_;
    std::vector<std::string> vulkan_names_;  // of extensions that XR_KHR_vulkan_enable asks for
    XrOwnedInstance instance_;
    XrSystemId system_ = XR_NULL_SYSTEM_ID;
    std::string name_, headset_;
    bool tracks_position_ = false, tracks_hands_ = false;
    std::array<XrViewConfigurationView, kEyes> views_{};
    std::vector<XrEnvironmentBlendMode> blend_modes_;
};

const char* blend_mode_name(XrEnvironmentBlendMode mode);

}  // namespace neuvv::xr
