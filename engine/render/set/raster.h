// The raster pass: an animated glTF scene to images, for captures. set_raster.h draws the meshes of a stage.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "media/image.h"
#include "render/set/scene_geometry.h"
#include "shared/raster.h"
#include "stage/camera.h"

namespace neuvv::render {

// Images are drawn this many times larger, with 4 samples a pixel, and averaged down by box_down.
constexpr uint32_t kSupersample = 2;

// The result of a draw: linear premultiplied RGBA as binary16, in rows from the top, kSupersample times larger along
// each axis. It covers only the part of the camera's image where the scene may be visible; the rest is transparent.
struct RasterImage {
    uint32_t x = 0, y = 0, width = 0, height = 0;  // the part, in pixels of the camera's image
    std::span<const uint16_t> halves;
};

// Draws one scene at one image size. Vertices are posed on the CPU, as a capture draws dozens of images of each time.
class Rasterizer {
  public:
    // Throws RuntimeFailure where the scene exceeds the device's memory or limits. Device and scene must outlive it.
    Rasterizer(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height);
    Rasterizer(const Rasterizer&) = delete;
    Rasterizer& operator=(const Rasterizer&) = delete;

    // Poses the scene for the following draws.
    void pose(const stage::PosedScene& pose);

    // Draws and waits. The result is valid until the next call. The camera must have the rasterizer's image size
    // (assert). `near_m` is the distance of the near plane.
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

// The matrix from world space to Vulkan's clip space, with y downwards and reversed depth: 1 at the near plane
// `near_m`, 0 at infinity.
glm::dmat4 clip_from_world(const stage::Camera& camera, double near_m);

// Averages blocks of kSupersample² pixels. Returns the whole image, width × height pixels of linear premultiplied RGBA.
std::vector<glm::vec4> box_down(const RasterImage& image, uint32_t width, uint32_t height);

// Converts linear premultiplied RGBA to sRGB with straight alpha, 8 bits a channel.
media::Image encode_straight(std::span<const glm::vec4> premultiplied, uint32_t width, uint32_t height);

// The mip levels of an sRGB image, in its encoding. They are averaged in linear light, weighted by alpha; the first
// level is the image itself.
std::vector<std::vector<uint8_t>> mip_levels(const media::Image& image);
// The mip levels of a map whose bytes are numbers, such as normals or roughness: plain averages.
std::vector<std::vector<uint8_t>> mip_levels_of_numbers(const media::Image& image);

}  // namespace neuvv::render
