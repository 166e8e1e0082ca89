// A window on the desktop that shows the image of the left eye.
#pragma once

#include "gpu/image.h"
#include "gpu/swapchain.h"
#include "tools/ui/window.h"

namespace neuvv::headset {

class Mirror {
  public:
    // `eye` is the size of the eye's image in pixels. The window must outlive the mirror, and must have been created
    // before the device.
    Mirror(const gpu::Device& device, ui::Window& window, VkExtent2D eye);

    // Shows the image (R8G8B8A8 sRGB, layout TRANSFER_SRC) in the middle of the window, as large as fits; null shows
    // nothing new. Leaves the image out where the window still shows an earlier one. Returns whether the window is
    // open.
    bool show(const gpu::DeviceImage* image);

  private:
    void record(const gpu::DeviceImage& image, const gpu::PresentTarget& target);
    const gpu::Device& device_;
    ui::Window& window_;
    gpu::Swapchain swapchain_;
    gpu::DeviceImage values_;  // a copy of the image whose values are not converted from sRGB
    gpu::Commands commands_;
};

}  // namespace neuvv::headset
