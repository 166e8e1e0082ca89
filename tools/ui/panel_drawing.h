// Draws ImGui's panels on the device: it owns the fonts and pipelines, and draws into images of one format. The window
// and the headset's panel both use it.
#pragma once

#include "gpu/image.h"

namespace neuvv::ui {

// There is one at a time: ImGui's context lives as long as the object.
class PanelDrawing {
  public:
    // Draws into UNORM images of this format, whose values are sRGB. At most `images` frames are in flight at once.
    // `scale` is that of fonts and panels.
    PanelDrawing(const gpu::Device& device, VkFormat format, uint32_t images, float scale);
    ~PanelDrawing();
    PanelDrawing(const PanelDrawing&) = delete;
    PanelDrawing& operator=(const PanelDrawing&) = delete;

    // The render pass that framebuffers are made for.
    VkRenderPass render_pass() const { return render_pass_; }
    float scale() const { return scale_; }
    // Loads fonts of another size. Do not call it between new_frame() and record().
    void set_scale(float scale);
    void new_frame();
    // Draws what ImGui::Render() has left over the content of the image, whose layout is and stays
    // COLOR_ATTACHMENT_OPTIMAL.
    void record(gpu::Commands& commands, VkFramebuffer framebuffer, VkExtent2D extent);

  private:
    void make_render_pass();
    void start_backend();
    void end();
    void make_fonts();
    const gpu::Device& device_;
    VkFormat format_;
    uint32_t images_;
    float scale_;
    VkRenderPass render_pass_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
};

// A framebuffer of one image view for the render pass of `drawing`; the caller destroys it.
VkFramebuffer make_framebuffer(const gpu::Device& device, const PanelDrawing& drawing, VkImageView view,
                               VkExtent2D extent);

}  // namespace neuvv::ui
