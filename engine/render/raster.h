// The raster pass: an animated glTF scene to images, for captures. set_raster.h draws the meshes of a stage.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "media/image.h"
#include "render/scene_geometry.h"
#include "shared/raster.h"
#include "stage/camera.h"

namespace neuvv::render {

// Images are drawn this many times larger, with 4 samples a pixel, and averaged down by box_down.
constexpr uint32_t kSupersample = 2;

// What a draw left: linear premultiplied RGBA as binary16, rows from the top, kSupersample times larger each way. Only
// the part of the camera's image that can show something; the rest is transparent.
struct RasterImage {
    uint32_t x = 0, y = 0, width = 0, height = 0;  // the part, in the camera's pixels
    std::span<const uint16_t> halves;
};

// Draws one scene at one image size. Vertices are posed on the CPU: a capture draws dozens of images of a time.
class Rasterizer {
  public:
    // Throws RuntimeFailure where the scene exceeds the device. The scene must outlive this.
    Rasterizer(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height);
    Rasterizer(const Rasterizer&) = delete;
    Rasterizer& operator=(const Rasterizer&) = delete;

    // The time that draw() shows.
    void pose(const stage::PosedScene& pose);

    // Draws and waits; the result is valid until the next call. The camera has the rasterizer's image size. `near_m`:
    // what is nearer to the camera's plane is cut off.
    RasterImage draw(const stage::Camera& camera, double near_m);

  private:
    void upload_textures();
    VkRect2D visible_part(const glm::dmat4& clip_from_world) const;
    void record(const glm::mat4& clip_from_world, const VkRect2D& part);
    void record_draws(const glm::mat4& clip_from_world, bool blended);
    void begin_rendering(const VkRect2D& part);

    const gpu::Device& device_;
    const stage::GltfScene& scene_;
    uint32_t width_, height_;  // of the targets
    gpu::GraphicsPass pass_;
    SceneGeometry geometry_;
    gpu::Buffer readback_;
    gpu::DeviceImage samples_, depth_, target_;
    SceneTextures textures_;
    std::vector<size_t> texture_of_draw_;
    std::vector<gpu::TextureSet> sets_;  // by texture
    gpu::Commands commands_;
};

// Clip space of Vulkan (y down, depth reversed: near 1, infinity 0) from world.
glm::dmat4 clip_from_world(const stage::Camera& camera, double near_m);

// Averages kSupersample² pixels into a whole image: width × height of linear premultiplied RGBA.
std::vector<glm::vec4> box_down(const RasterImage& image, uint32_t width, uint32_t height);

// Straight alpha, sRGB, 8 bits.
media::Image encode_straight(std::span<const glm::vec4> premultiplied, uint32_t width, uint32_t height);

// The mip levels of an image as R8G8B8A8_SRGB, averaged in linear light and weighted by alpha; the first is itself.
std::vector<std::vector<uint8_t>> mip_levels(const media::Image& image);
// The same of a map whose bytes are numbers (normals, roughness): plain averages.
std::vector<std::vector<uint8_t>> mip_levels_of_numbers(const media::Image& image);

}  // namespace neuvv::render
