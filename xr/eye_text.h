// Text in a headset's images: rectangles of EyeShapes that show parts of a font's image.
#pragma once

#include <optional>

#include "gpu/graphics_pass.h"
#include "shared/eye.h"
#include "xr/eye_shapes.h"

namespace neuvv::xr {

class EyeText {
  public:
    EyeText(const gpu::Device& device, VkFormat colour, VkFormat depth);

    // Without a font no text is drawn. The image (red is how much of a pixel is covered; layout SHADER_READ_ONLY) must
    // outlive this object. To be called while no frame is drawn.
    void set_font(const gpu::DeviceImage& image);
    // Records the draw of `text`, inside the eyes' rendering. What it recorded before must be finished.
    void draw(gpu::Commands& commands, std::span<const TextVertex> text, const ShapePush& views);

  private:
    gpu::GraphicsPass pass_;
    gpu::Sampler sampler_;
    std::optional<gpu::TextureSet> bound_;  // once there is a font
    gpu::Buffer vertices_;
};

}  // namespace neuvv::xr
