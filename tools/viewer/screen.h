// The window's contents: a picture, and ImGui's panels over it.
#pragma once

#include <memory>
#include <optional>

#include "gpu/image.h"
#include "gpu/swapchain.h"
#include "media/image.h"
#include "tools/viewer/window.h"

namespace neuvv {

// Part of an image (RGBA8, layout TRANSFER_SRC), and where it goes in the window, in the framebuffer's pixels.
struct ScreenPicture {
    std::shared_ptr<const DeviceImage> image;
    VkExtent2D size{};
    VkRect2D at{};
};

class Screen {
  public:
    // `scale`: of letters and panels. Both must outlive it; ImGui has its context as long as it lives.
    Screen(const Device& device, Window& window, float scale);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    float scale() const { return scale_; }
    // Other letters; not between begin() and end().
    void set_scale(float scale);

    // Then panels may be drawn with ImGui, until end(), which shows them over the picture. False: it could not just
    // now, and another frame is wanted.
    void begin();
    bool end(const ScreenPicture& picture);
    // end() keeps what the window shows from now on, until it is taken once.
    void capture_next() { capture_ = true; }
    std::optional<Image> take_capture();

  private:
    struct Frame;
    void make_render_pass();
    void make_framebuffers();
    void start_imgui();
    void start_drawing();
    void make_letters();
    void record(Commands& commands, const ScreenPicture& picture, const PresentTarget& target);
    void record_capture(Commands& commands, const PresentTarget& target);
    const Device& device_;
    Window& window_;
    float scale_;
    Swapchain swapchain_;
    VkRenderPass render_pass_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
    std::vector<VkFramebuffer> framebuffers_;
    std::unique_ptr<Frame> frames_[2];  // in flight in turn
    size_t turn_ = 0, captured_in_ = 0;
    bool capture_ = false;
    Buffer captured_;
    VkExtent2D captured_size_{};
};

}  // namespace neuvv
