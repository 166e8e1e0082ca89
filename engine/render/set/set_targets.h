// What the set of a stage is drawn to.
#pragma once

#include <vector>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/image.h"
#include "stage/camera.h"

namespace neuvv::render {

constexpr VkFormat kSetColour = VK_FORMAT_R16G16B16A16_SFLOAT, kSetMetres = VK_FORMAT_R32_SFLOAT;

// Owns all that has the size of a view: the images that are drawn to, and the buffers to which they are copied. All are
// of the same size, unless resize() has thrown.
struct SetTargets {
    // Throws RuntimeFailure where there is no memory.
    SetTargets(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t views);
    // Replaces images and buffers. Throws RuntimeFailure where there is no memory, and must then be called again before
    // anything is drawn.
    void resize(const gpu::Device& device, uint32_t width, uint32_t height);
    uint32_t views() const { return static_cast<uint32_t>(colour_images.size()); }

    uint32_t width, height;
    // Texel view · width · height + y · width + x, where width and height are those of the cameras that were drawn:
    gpu::Buffer colour;  // rgba16f, linear premultiplied light; alpha 0 where there is no set
    gpu::Buffer front;   // the same, of the blended pieces before the volumes
    gpu::Buffer depth;   // r32f, metres along the camera's axis; infinity where there is no opaque or masked set
    // r32f, metres along the camera's axis to the volumes; infinity where there are none, and until a pass writes it.
    gpu::Buffer volume_depth;

    std::vector<gpu::DeviceImage> colour_images, depth_images;  // by view
    gpu::DeviceImage metres_image, front_image;
};

// Between begin and end, a view's opaque and masked pieces are drawn → colour, depth.
void begin_solid(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view);
void end_solid(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view);
// Then its blended pieces, over what was drawn → colour, front.
void begin_blended(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view);
void end_blended(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view);

}  // namespace neuvv::render
