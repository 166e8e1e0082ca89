// The panel as a quad layer of the compositor: an image that ImGui draws, with a hand's pointer ray as its mouse.
#pragma once

#include <functional>

#include "tools/headset/hands/interaction.h"
#include "tools/ui/panel_drawing.h"
#include "xr/draw/swapchain.h"

namespace neuvv::headset {

// The panel's image in pixels, and the scale of its theme (ui::apply_theme): a line of text is 33 pixels high, which
// are 20 dmm (thousandths of the distance from which they are seen) where the panel is as narrow as kMinPanelWidth_rad,
// and 24 dmm elsewhere. Text of less is hard to read in a headset.
constexpr uint32_t kPanelWidth = 768, kPanelHeight = 1024;
constexpr float kPanelScale = 2.2f;

class PanelSurface {
  public:
    PanelSurface(const gpu::Device& device, const xr::Session& session);
    ~PanelSurface();
    PanelSurface(const PanelSurface&) = delete;
    PanelSurface& operator=(const PanelSurface&) = delete;

    // Draws the widgets that `draw_widgets` submits to ImGui, and waits for the device.
    void draw(const PanelPointer& pointer, double dt_s, const std::function<void()>& draw_widgets);
    // The layer with the image that was drawn last. It is valid until the next call.
    const XrCompositionLayerBaseHeader* layer(const xr::Session& session, const xr::Pose& tracking_from_panel,
                                              glm::dvec2 size_m);
    bool has_image() const { return has_image_; }
    // The image that was drawn last, with sRGB values in UNORM; layout SHADER_READ_ONLY.
    const gpu::DeviceImage& image() const { return imgui_image_; }

  private:
    void update_input(const PanelPointer& pointer, double dt_s);
    void record(VkImage to);
    const gpu::Device& device_;
    xr::SwapchainImages images_;
    gpu::DeviceImage imgui_image_;  // what ImGui draws to; UNORM, as its colours are sRGB already
    ui::PanelDrawing drawing_;
    bool has_image_ = false;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    gpu::Commands commands_;
    XrCompositionLayerQuad quad_{XR_TYPE_COMPOSITION_LAYER_QUAD};
};

}  // namespace neuvv::headset
