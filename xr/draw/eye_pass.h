// Eye pass: draws the rendered images of a stage, their depth, and shapes over them to a headset's images. One pass
// draws all views: each view is a layer of the target and an instance of each draw. (Multiview is not used, as lavapipe
// of Mesa 22.3 draws whole tiles of all views to the first layer.)
#pragma once

#include <array>
#include <memory>
#include <span>

#include "gpu/graphics_pass.h"
#include "render/clips/stage_renderer.h"
#include "xr/draw/eye_shapes.h"
#include "xr/draw/eye_text.h"
#include "xr/draw/swapchain.h"
#include "xr/locomotion.h"

namespace neuvv::xr {

// The formats that the pass can draw to. Colour is that of 8-bit images: floats, which some runtimes prefer, would take
// twice the memory and show no more.
const std::vector<VkFormat>& eye_colour_formats();
const std::vector<VkFormat>& eye_depth_formats();

struct EyeTarget {
    VkImage colour = VK_NULL_HANDLE, depth = VK_NULL_HANDLE;  // a layer for each view
    VkImageView colour_view = VK_NULL_HANDLE, depth_view = VK_NULL_HANDLE;
    VkExtent2D size{};  // of the part that is drawn, from the upper left
};

class EyePass {
  public:
    // Throws RuntimeFailure where the device does not have Device::output_layer.
    EyePass(const gpu::Device& device, VkFormat colour, VkFormat depth);

    // Records how the images of the renderer, and the shapes over them, are drawn: behind the images in their
    // submission (FrameRenderer::Then). Of what it recorded before, the last may be under way. `cameras` are those of
    // the images, as many as there are views (a multiple of kEyes), and have the target's size. Leaves the target in
    // the layouts in which OpenXR expects it (COLOR_ATTACHMENT_OPTIMAL and DEPTH_STENCIL_ATTACHMENT_OPTIMAL).
    void record(gpu::Commands& commands, const render::StageRenderer& renderer, const gpu::Buffer& images,
                std::span<const stage::Camera> cameras, const EyeShapes& shapes, const EyeShade& shade,
                const EyeTarget& target);
    void set_font(const gpu::DeviceImage& image) { text_.set_font(image); }

  private:
    void bind(const render::StageRenderer& renderer, const gpu::Buffer& images);
    void upload(const EyeShapes& shapes);
    void draw_image(gpu::Commands& commands, const render::ViewLayout& layout, const EyeShade& shade);
    void draw_shapes(gpu::Commands& commands, std::span<const stage::Camera> cameras, const EyeShapes& shapes);
    const gpu::Device& device_;
    gpu::GraphicsPass image_, solid_, translucent_, on_top_;
    EyeText text_;
    gpu::TextureSet bound_;
    std::array<VkBuffer, 2> bound_to_{};  // images and the set's depth; to notice that the renderer has new buffers
    std::array<gpu::Buffer, render::kImagesUnderWay> vertices_;  // in turn; the first is that of the last image
};

}  // namespace neuvv::xr
