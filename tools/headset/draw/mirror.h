// A window on the desktop that shows what the left eye sees: its image, and the panel, which is a layer beneath it.
#pragma once

#include <optional>

#include "gpu/graphics_pass.h"
#include "gpu/swapchain.h"
#include "stage/camera.h"
#include "tools/headset/state/panel_placement.h"
#include "tools/ui/window.h"

namespace neuvv::headset {

// The panel, with the camera of the left eye that sees it.
struct MirroredPanel {
    PanelPlacement placement;
    stage::Camera camera;
};

class Mirror {
  public:
    // `eye` is the size of the eye's image in pixels. `panel` is the panel's image, with sRGB values in UNORM, in
    // layout SHADER_READ_ONLY. Window and image must outlive the mirror, and the window must have been created before
    // the device.
    Mirror(const gpu::Device& device, ui::Window& window, VkExtent2D eye, const gpu::DeviceImage& panel);
    ~Mirror();
    Mirror(const Mirror&) = delete;
    Mirror& operator=(const Mirror&) = delete;

    // Shows the eye's image (R8G8B8A8 sRGB, layout TRANSFER_SRC, always the same one) in the centre of the window, as
    // large as fits, with the panel where the image is transparent; null shows nothing new. Leaves the image out where
    // the window still shows an earlier one. Returns whether the window is open.
    bool show(const gpu::DeviceImage* image, const std::optional<MirroredPanel>& panel);

  private:
    void record(const gpu::DeviceImage& image, const std::optional<MirroredPanel>& panel,
                const gpu::PresentTarget& target);
    void draw(const gpu::DeviceImage& image, const std::optional<MirroredPanel>& panel);
    const gpu::Device& device_;
    ui::Window& window_;
    const gpu::DeviceImage& panel_;
    gpu::Swapchain swapchain_;
    gpu::DeviceImage values_;  // what is shown, sRGB in UNORM, so that the window's format does not convert it
    gpu::GraphicsPass pass_;
    gpu::Sampler sampler_;
    std::optional<gpu::TextureSet> bound_;  // once there is an image
    gpu::Commands commands_;
};

}  // namespace neuvv::headset
