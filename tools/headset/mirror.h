// A window on the desktop that shows what the left eye sees.
#pragma once

#include "gpu/image.h"
#include "gpu/swapchain.h"
#include "tools/ui/window.h"

namespace neuvv::headset {

class Mirror {
  public:
    // `eye`: pixels of what is shown. The window outlives it, and was made before the device.
    Mirror(const gpu::Device& device, ui::Window& window, VkExtent2D eye);

    // The image (R8G8B8A8 sRGB, layout TRANSFER_SRC) in the middle of the window, as large as it fits. False: the
    // window was closed.
    bool show(const gpu::DeviceImage* image);

  private:
    void record(const gpu::DeviceImage& image, const gpu::PresentTarget& target);
    const gpu::Device& device_;
    ui::Window& window_;
    gpu::Swapchain swapchain_;
    gpu::DeviceImage values_;  // the image's sRGB values as they are
    gpu::Commands commands_;
};

}  // namespace neuvv::headset
