// Eye pass: a stage's pictures, their depth and shapes over them → a headset's images, both eyes in one pass: a layer
// and an instance each. (Not by multiview: lavapipe of Mesa 22.3 draws whole tiles of all views to the first layer.)
#pragma once

#include <array>
#include <memory>

#include "gpu/graphics_pass.h"
#include "render/stage_renderer.h"
#include "xr/eye_shapes.h"
#include "xr/swapchain.h"

namespace neuvv {

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
    EyePass(const Device& device, VkFormat colour, VkFormat depth);

    // Waits. Draws the renderer's last pictures of `cameras` (left, right), which have the target's size, and the
    // shapes; images are left as OpenXR wants them. `vignette`: 0..1.
    void draw(const StageRenderer& renderer, const Buffer& pictures, const std::array<Camera, kEyes>& cameras,
              const EyeShapes& shapes, double vignette, const EyeTarget& target);

    std::vector<PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    void bind(const StageRenderer& renderer, const Buffer& pictures);
    void upload(const EyeShapes& shapes);
    void record(const std::array<Camera, kEyes>& cameras, const ViewLayout& layout, const EyeShapes& shapes,
                double vignette, const EyeTarget& target);
    void draw_picture(const ViewLayout& layout, double vignette);
    void draw_shapes(const std::array<Camera, kEyes>& cameras, const EyeShapes& shapes);
    const Device& device_;
    GraphicsPass picture_, solid_, clear_, through_;
    TextureSet bound_;
    std::array<VkBuffer, 2> bound_to_{};  // pictures and the set's depth: others where targets were made anew
    Buffer vertices_;
    Commands commands_;
};

}  // namespace neuvv
