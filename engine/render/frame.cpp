#include "render/frame.h"

#include <fmt/format.h>

#include <cstring>

#include "base/error.h"

namespace neuvv {

namespace {

uint32_t tile_count(uint32_t width, uint32_t height) {
    return ((width + kTile - 1) / kTile) * ((height + kTile - 1) / kTile);
}

// Tiles of a picture's rays. Throws RuntimeFailure where the device cannot address so many rays.
uint32_t checked_tiles(const Device& device, uint32_t width, uint32_t height, uint32_t samples) {
    const uint64_t across = (uint64_t{samples} * width + kTile - 1) / kTile;
    const uint64_t down = (uint64_t{samples} * height + kTile - 1) / kTile;
    if (across * down * kTilePixels > device.limits().maxTexelBufferElements)
        throw RuntimeFailure(
            fmt::format("{}x{} pixels of {} rays are too many for this device; choose a smaller --size "
                        "or --samples",
                        width, height, samples * samples));
    return tile_count(samples * width, samples * height);
}

// Per-ray values from tile order into rows.
template <typename T>
std::vector<T> rows_from_tiles(const std::vector<T>& rays, uint32_t width, uint32_t height) {
    const uint32_t across = (width + kTile - 1) / kTile;
    std::vector<T> rows(size_t{width} * height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t tile = size_t{y / kTile} * across + x / kTile;
            rows[size_t{y} * width + x] = rays[tile * kTilePixels + y % kTile * kTile + x % kTile];
        }
    return rows;
}

}  // namespace

void record_frame(Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    const uint32_t tiles = tile_count(settings.samples * settings.width, settings.samples * settings.height);
    if (settings.mode == TraceMode::kSlice) {
        record_slice(commands, r.slicer_, settings.frame);
        record_trace(commands, r.tracer_, tiles, settings.stop);
    } else {
        record_rows(commands, r.slicer_, settings.frame);
        record_direct(commands, r.direct_, tiles, settings.stop);
    }
    record_resolve(commands, r.resolver_, settings.width, settings.height, settings.samples, settings.resolve);
    copy(commands, r.picture_, r.readback_, uint64_t{4} * settings.width * settings.height);
    host_barrier(commands);
}

FrameRenderer::FrameRenderer(const Device& device, const Field& field, uint32_t max_width, uint32_t max_height,
                             uint32_t max_samples)
    : device_(device),
      slice_(device, field, field.leaf_count),
      rays_(device, 1, checked_tiles(device, max_width, max_height, max_samples)),
      picture_(device, "picture", uint64_t{4} * max_width * max_height, MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "picture readback", uint64_t{4} * max_width * max_height, MemoryKind::kReadback),
      slicer_(device, field, slice_),
      tracer_(device, field, slice_, rays_),
      direct_(device, field, slice_, rays_),
      resolver_(device, rays_, picture_),
      commands_(device, "frame") {}

Image FrameRenderer::render(const Camera& camera, const FrameSettings& settings) {
    const std::vector<Tile> tiles =
        tiles_of_picture(0, settings.samples * settings.width, settings.samples * settings.height);
    Image image(settings.width, settings.height);
    if (tiles.size() > rays_.tile_capacity || image.rgba.size() > readback_.bytes)
        throw RuntimeFailure(
            fmt::format("a picture of {}x{} is larger than its renderer", settings.width, settings.height));
    *rays_.cameras.as<ShaderCamera>() = shader_camera(enlarged(camera, settings.samples), settings.samples);
    std::memcpy(rays_.tiles.mapped, tiles.data(), tiles.size() * sizeof(Tile));
    commands_.begin();
    record_frame(commands_, *this, settings);
    commands_.submit();
    commands_.wait();
    std::memcpy(image.rgba.data(), readback_.mapped, image.rgba.size());
    return image;
}

std::vector<glm::vec4> FrameRenderer::radiance(uint32_t width, uint32_t height) const {
    std::vector<glm::vec4> rays(size_t{tile_count(width, height)} * kTilePixels);
    download(device_, rays_.radiance, rays.data(), rays.size() * sizeof(glm::vec4));
    return rows_from_tiles(rays, width, height);
}

std::vector<float> FrameRenderer::depth(uint32_t width, uint32_t height) const {
    std::vector<float> rays(size_t{tile_count(width, height)} * kTilePixels);
    download(device_, rays_.depth, rays.data(), rays.size() * sizeof(float));
    return rows_from_tiles(rays, width, height);
}

}  // namespace neuvv
