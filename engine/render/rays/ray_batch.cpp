#include "render/rays/ray_batch.h"

#include <algorithm>

namespace neuvv::render {

RayBatch::RayBatch(const gpu::Device& device, uint32_t camera_count, uint32_t tile_count, gpu::MemoryKind cameras_in)
    : camera_capacity(std::max(camera_count, 1u)),
      tile_capacity(std::max(tile_count, 1u)),
      cameras(device, "cameras", sizeof(ShaderCamera) * uint64_t{camera_capacity}, cameras_in,
              VK_FORMAT_R32G32B32A32_SFLOAT),
      tiles(device, "tiles", sizeof(Tile) * uint64_t{tile_capacity}, gpu::MemoryKind::kUpload,
            VK_FORMAT_R32G32B32A32_UINT),
      radiance(device, "radiance", uint64_t{16} * kTilePixels * tile_capacity, gpu::MemoryKind::kDevice,
               VK_FORMAT_R32G32B32A32_SFLOAT),
      depth(device, "depth", uint64_t{4} * kTilePixels * tile_capacity, gpu::MemoryKind::kDevice,
            VK_FORMAT_R32_SFLOAT) {}

ShaderCamera shader_camera(const stage::Camera& camera, uint32_t samples) {
    const glm::dmat3 rotation(camera.world_from_camera);
    ShaderCamera shader{};
    shader.origin = glm::vec4(glm::vec3(camera.world_from_camera[3]), 0);
    shader.right = glm::vec4(glm::vec3(rotation * glm::dvec3(1 / camera.fx, 0, 0)), static_cast<float>(camera.width));
    shader.down = glm::vec4(glm::vec3(rotation * glm::dvec3(0, -1 / camera.fy, 0)), static_cast<float>(camera.height));
    shader.corner = glm::vec4(glm::vec3(rotation * glm::dvec3(-camera.cx / camera.fx, camera.cy / camera.fy, -1)),
                              static_cast<float>(samples));
    const auto whole = [](uint32_t pixels) {
        const auto end = static_cast<float>(pixels);
        return GridAxis{{0, end, 0, end}, glm::vec4(1)};
    };
    shader.across = whole(camera.width);
    shader.downwards = whole(camera.height);
    return shader;
}

stage::Camera in_performer(stage::Camera camera, const glm::mat4& world_from_performer) {
    camera.world_from_camera = glm::inverse(glm::dmat4(world_from_performer)) * camera.world_from_camera;
    return camera;
}

std::vector<Tile> tiles_of_image(uint32_t camera, uint32_t width, uint32_t height) {
    std::vector<Tile> tiles;
    for (uint32_t y = 0; y < height; y += kTile)
        for (uint32_t x = 0; x < width; x += kTile) tiles.push_back({camera, x, y, 0});
    return tiles;
}

void record_clear(gpu::Commands& commands, const RayBatch& rays, uint32_t tiles) {
    const gpu::PassScope scope(commands, "clear");
    constexpr uint32_t kInfinity = 0x7f800000;
    gpu::fill(commands, rays.radiance, 0, uint64_t{16} * kTilePixels * tiles);
    gpu::fill(commands, rays.depth, kInfinity, uint64_t{4} * kTilePixels * tiles);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
