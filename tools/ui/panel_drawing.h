// Draws ImGui's panels on the device: it owns the fonts and pipelines, and draws into images of one format. The window
// and the headset's panel both use it.
#pragma once

#include "gpu/image.h"

namespace neuvv::ui {

// ImGui's context begins with this object and ends with it.
class PanelDrawing {
  public:
    // Into UNORM images, whose values are sRGB; so many may be in flight at once. `scale` is that of fonts and panels.
    PanelDrawing(const gpu::Device& device, VkFormat format, uint32_t images, float scale);
    ~PanelDrawing();
    PanelDrawing(const PanelDrawing&) = delete;
    PanelDrawing& operator=(const PanelDrawing&) = delete;

    // Framebuffers are made for it.
    VkRenderPass render_pass() const { return render_pass_; }
    float scale() const { return scale_; }
    // Loads fonts of another size; not between two frames of ImGui.
    void set_scale(float scale);
    void new_frame();
    // What ImGui::Render() left, over what the image shows (layout COLOR_ATTACHMENT_OPTIMAL, and stays so).
    void record(gpu::Commands& commands, VkFramebuffer framebuffer, VkExtent2D extent);

  private:
    void make_render_pass();
    void start();
    void make_fonts();
    const gpu::Device& device_;
    VkFormat format_;
    uint32_t images_;
    float scale_;
    VkRenderPass render_pass_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
};

// One image view of that render pass.
VkFramebuffer make_framebuffer(const gpu::Device& device, const PanelDrawing& drawing, VkImageView view,
                               VkExtent2D extent);

}  // namespace neuvv::ui
