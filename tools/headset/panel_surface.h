// The panel as an image: ImGui drawn into a quad layer, with a hand's ray as its mouse.
#pragma once

#include <functional>

#include "tools/headset/interaction.h"
#include "tools/viewer/panel_drawing.h"
#include "xr/swapchain.h"

namespace neuvv {

class PanelSurface {
  public:
    PanelSurface(const Device& device, const Session& session);
    ~PanelSurface();
    PanelSurface(const PanelSurface&) = delete;
    PanelSurface& operator=(const PanelSurface&) = delete;

    // Draws what `panels` puts up with ImGui. Waits for the device.
    void draw(const PanelPointer& pointer, double dt_s, const std::function<void()>& panels);
    // What was drawn last, where the panel stands in tracking space.
    const XrCompositionLayerBaseHeader* layer(const Session& session, const Pose& tracking_from_panel,
                                              glm::dvec2 size_m);
    bool has_picture() const { return has_picture_; }

  private:
    void feed(const PanelPointer& pointer, double dt_s);
    void record(VkImage to);
    const Device& device_;
    XrImages images_;
    DeviceImage drawn_;  // UNORM: ImGui's colours are sRGB already
    PanelDrawing drawing_;
    bool has_picture_ = false;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    Commands commands_;
    XrCompositionLayerQuad quad_{XR_TYPE_COMPOSITION_LAYER_QUAD};
};

}  // namespace neuvv
