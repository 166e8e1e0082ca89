// Text in a headset's images: rectangles of EyeShapes that show parts of a font's image.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "gpu/graphics_pass.h"
#include "render/rays/ray_target.h"
#include "shared/eye.h"
#include "xr/draw/eye_shapes.h"

namespace neuvv::xr {

class EyeText {
  public:
    EyeText(const gpu::Device& device, VkFormat colour, VkFormat depth);

    // Without a font no text is drawn. The image (red is how much of a pixel is covered; layout SHADER_READ_ONLY) must
    // outlive this object. To be called while no frame is drawn.
    void set_font(const gpu::DeviceImage& image);
    // Records the draw of `text`, inside the eyes' rendering. `pairs` are the matrices of the views, two by two. Of
    // what it recorded before, the last may be under way.
    void draw(gpu::Commands& commands, std::span<const TextVertex> text, std::span<const ShapePush> pairs);

  private:
    gpu::GraphicsPass pass_;
    gpu::Sampler sampler_;
    std::optional<gpu::TextureSet> bound_;                       // once there is a font
    std::array<gpu::Buffer, render::kImagesUnderWay> vertices_;  // in turn; the first is that of the last image
};

}  // namespace neuvv::xr
