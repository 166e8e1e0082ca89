// The window's contents: an image, and ImGui's panels over it.
#pragma once

#include <memory>
#include <optional>

#include "gpu/image.h"
#include "gpu/swapchain.h"
#include "media/image.h"
#include "tools/ui/panel_drawing.h"
#include "tools/ui/window.h"

namespace neuvv::viewer {

// Part of an image (RGBA8, layout TRANSFER_SRC), and where it goes in the window, in the framebuffer's pixels.
struct ScreenImage {
    std::shared_ptr<const gpu::DeviceImage> image;
    VkExtent2D size{};
    VkRect2D at{};
};

class Screen {
  public:
    // `scale`: of letters and panels. Both must outlive it; ImGui has its context as long as it lives.
    Screen(const gpu::Device& device, ui::Window& window, float scale);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    float scale() const { return drawing_->scale(); }
    // Other letters; not between begin() and end().
    void set_scale(float scale) { drawing_->set_scale(scale); }

    // Then panels may be drawn with ImGui, until end(), which shows them over the image. False: it could not just
    // now, and another frame is wanted.
    void begin();
    bool end(const ScreenImage& image);
    // end() keeps what the window shows from now on, until it is taken once.
    void capture_next() { capture_ = true; }
    std::optional<media::Image> take_capture();

  private:
    struct Frame;
    void make_framebuffers();
    void record(gpu::Commands& commands, const ScreenImage& image, const gpu::PresentTarget& target);
    void record_capture(gpu::Commands& commands, const gpu::PresentTarget& target);
    const gpu::Device& device_;
    ui::Window& window_;
    gpu::Swapchain swapchain_;
    std::unique_ptr<ui::PanelDrawing> drawing_;
    std::vector<VkFramebuffer> framebuffers_;
    std::unique_ptr<Frame> frames_[2];  // in flight in turn
    size_t turn_ = 0, captured_in_ = 0;
    bool capture_ = false;
    gpu::Buffer captured_;
    VkExtent2D captured_size_{};
};

}  // namespace neuvv::viewer
