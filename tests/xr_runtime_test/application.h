// A minimal correct OpenXR application, step by step through the real loader: an instance, a Vulkan device, a session,
// frames with a projection layer with depth and a quad layer, and actions. All that it passes to OpenXR is in plain
// structs, so that a test can make one thing wrong.
#pragma once

#include <volk.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "support/temporary_folder.h"

namespace neuvv::test {

// The arguments of xrEndFrame.
struct Frame {
    XrFrameState state;
    std::array<XrView, 2> views;
    std::array<XrCompositionLayerDepthInfoKHR, 2> depth;
    std::array<XrCompositionLayerProjectionView, 2> eyes;
    XrCompositionLayerProjection projection;
    XrCompositionLayerQuad quad;
    std::vector<const XrCompositionLayerBaseHeader*> layers;
    XrFrameEndInfo end;
};

// Each step first takes the steps before it that are missing. A step throws where one of its calls fails.
class Application {
  public:
    Application();
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;
    ~Application();

    // The runtime's script, and the extensions that the application enables; to be changed before make_instance.
    nlohmann::json script;
    std::vector<const char*> extensions;

    // Sets the environment variables by which loader and runtime find manifest, script and report; make_instance calls
    // it.
    void set_environment();
    void make_instance();
    void make_device();
    void make_session();
    // Makes the session run, in the state READY.
    void begin_session();
    // Waits for a frame, begins it and fills it correctly: with layers where the frame should be rendered.
    void prepare_frame();
    XrResult end_frame();
    // Runs frames up to the first one that should be rendered, and prepares that one.
    void prepare_visible_frame();
    // Runs frames until the session has the input focus; leaves it between two frames.
    void make_focused();
    // An action set of a button, a pose and a vibration, with the bindings of one controller.
    void make_actions();
    void suggest_bindings();
    void attach_actions();
    XrResult sync_actions();

    void poll_events();
    // Acquires a swapchain's next image, waits for it and releases it.
    static void draw_to(XrSwapchain swapchain);
    void destroy_session();
    // Ends correctly, from any step, so that the application can start again. Returns the runtime's report.
    nlohmann::json end();

    XrInstanceCreateInfo instance_info() const;
    XrSessionCreateInfo session_info() const;
    XrSwapchainCreateInfo swapchain_info(VkFormat format, uint32_t layers = 1) const;
    static XrReferenceSpaceCreateInfo space_info(XrReferenceSpaceType type = XR_REFERENCE_SPACE_TYPE_LOCAL);
    XrActionCreateInfo action_info(const char* name, XrActionType type) const;
    XrViewLocateInfo locate_info(XrTime time) const;
    XrResult locate_views(XrTime time);
    XrPath path(const char* text) const;
    template <typename Function>
    Function function(const char* name) const {
        PFN_xrVoidFunction found = nullptr;
        xrGetInstanceProcAddr(instance, name, &found);
        if (!found) throw std::runtime_error(std::string(name) + " is not to be had");
        return reinterpret_cast<Function>(found);
    }

    XrInstance instance = XR_NULL_HANDLE;
    XrSystemId system = XR_NULL_SYSTEM_ID;
    XrGraphicsBindingVulkanKHR binding = {XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR};
    XrSession session = XR_NULL_HANDLE;
    XrSpace space = XR_NULL_HANDLE;  // LOCAL
    XrSwapchain colour = XR_NULL_HANDLE, depth = XR_NULL_HANDLE, panel = XR_NULL_HANDLE;
    Frame frame = {};
    XrActionSet action_set = XR_NULL_HANDLE;
    XrAction press = XR_NULL_HANDLE, grip = XR_NULL_HANDLE, buzz = XR_NULL_HANDLE;
    std::array<XrPath, 2> hands = {};
    std::vector<XrSessionState> states;  // by the events
    std::vector<XrEventDataBuffer> events;

  private:
    bool has(const char* extension) const;
    // Creates the device by XR_KHR_vulkan_enable2 where that is enabled, else by XR_KHR_vulkan_enable.
    void ask_requirements() const;
    void make_vulkan_instance();
    void find_physical_device();
    void make_vulkan_device();
    void destroy_device();
    void fill_layers();
    void leave_session();

    bool is_running_ = false;
    TemporaryFolder folder_;
};

// Throws where the call failed.
void check(XrResult result, const char* call);

}  // namespace neuvv::test
