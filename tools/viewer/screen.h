// Draws the window's contents: an image, and the panels of ImGui over it.
#pragma once

#include <memory>
#include <optional>

#include "gpu/image.h"
#include "gpu/swapchain.h"
#include "media/image.h"
#include "tools/ui/panel_drawing.h"
#include "tools/ui/window.h"

namespace neuvv::viewer {

// The upper left part of an image (RGBA8, layout TRANSFER_SRC), and the area of the window that it fills.
struct ScreenImage {
    std::shared_ptr<const gpu::DeviceImage> image;  // null: no image
    VkExtent2D size{};                              // of the part, pixels of the image
    VkRect2D area{};                                // pixels of the framebuffer
};

class Screen {
  public:
    // `scale` is that of fonts and panels. The device and the window must outlive this object. The context of ImGui
    // begins and ends with it.
    Screen(const gpu::Device& device, ui::Window& window, float scale);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    float scale() const { return drawing_->scale(); }
    // Loads fonts of another size. Not to be called between begin() and end().
    void set_scale(float scale) { drawing_->set_scale(scale); }

    // Panels are drawn with ImGui between begin() and end(), which presents them over the image. Returns false where
    // the swapchain had no image to draw into: then another frame has to be drawn.
    void begin();
    bool end(const ScreenImage& image);
    // The next end() also copies the window's contents. take_capture() returns this copy once, and nullopt before.
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
    std::unique_ptr<Frame> frames_[2];           // used in turn: one may be in flight while the other is recorded
    size_t next_frame_ = 0, capture_frame_ = 0;  // indices of frames_; of the frame that copied the contents
    bool capture_ = false;                       // requested by capture_next()
    gpu::Buffer captured_;
    VkExtent2D captured_size_{};
};

}  // namespace neuvv::viewer
