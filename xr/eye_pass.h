// Eye pass: a stage's images, their depth and shapes over them → a headset's images, both eyes in one pass: a layer
// and an instance each. (Not by multiview: lavapipe of Mesa 22.3 draws whole tiles of all views to the first layer.)
#pragma once

#include <array>
#include <memory>

#include "gpu/graphics_pass.h"
#include "render/stage_renderer.h"
#include "xr/eye_shapes.h"
#include "xr/swapchain.h"

namespace neuvv::xr {

// What the pass can draw to.
const std::vector<VkFormat>& eye_colour_formats();
const std::vector<VkFormat>& eye_depth_formats();

struct EyeTarget {
    VkImage colour = VK_NULL_HANDLE, depth = VK_NULL_HANDLE;  // two layers each
    VkImageView colour_view = VK_NULL_HANDLE, depth_view = VK_NULL_HANDLE;
    VkExtent2D size{};
};

class EyePass {
  public:
    // Throws RuntimeFailure for a device without Device::output_layer.
    EyePass(const gpu::Device& device, VkFormat colour, VkFormat depth);

    // Waits. Draws the renderer's last images of `cameras` (left, right), which have the target's size, and the
    // shapes; images are left as OpenXR wants them. `vignette`: 0..1.
    void draw(const render::StageRenderer& renderer, const gpu::Buffer& images,
              const std::array<stage::Camera, kEyes>& cameras, const EyeShapes& shapes, double vignette,
              const EyeTarget& target);

    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    void bind(const render::StageRenderer& renderer, const gpu::Buffer& images);
    void upload(const EyeShapes& shapes);
    void record(const std::array<stage::Camera, kEyes>& cameras, const render::ViewLayout& layout,
                const EyeShapes& shapes, double vignette, const EyeTarget& target);
    void draw_image(const render::ViewLayout& layout, double vignette);
    void draw_shapes(const std::array<stage::Camera, kEyes>& cameras, const EyeShapes& shapes);
    const gpu::Device& device_;
    gpu::GraphicsPass image_, solid_, clear_, through_;
    gpu::TextureSet bound_;
    std::array<VkBuffer, 2> bound_to_{};  // images and the set's depth: others where targets were made anew
    gpu::Buffer vertices_;
    gpu::Commands commands_;
};

}  // namespace neuvv::xr
