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

TraceMode play_mode(const Field& field, glm::vec3 eye) {
    // Colours of degree 1 to 3 turn by some 0.1 to 0.3 a radian, to either side of the leaf's middle.
    constexpr float kSmallAngle = 0.02f;
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    return 0.5f * field.leaf_diagonal < kSmallAngle * glm::length(outside) ? TraceMode::kShaded : TraceMode::kTree;
}

SlotPath::SlotPath(const Device& device, const Field& field, const RayBatch& rays)
    : slice(device, field, field.leaf_count), slicer(device, field, slice), tracer(device, field, slice, rays) {}

TreePath::TreePath(const Device& device, const Field& field, const RayBatch& rays, const Buffer& picture)
    : live(device, field, field.leaf_count),
      tree(device, field, most_entries(field)),
      shaded(shaded_entries(device, tree.capacity)),
      ranges(device, rays.tile_capacity),
      slicer(device, field, live, tree),
      shader(device, field, tree, shaded),
      ranger(device, field, tree, ranges),
      unshaded_tracer(device, field, tree, tree.entries, ranges, rays, Shading::kPerRay),
      shaded_tracer(device, field, tree, shaded, ranges, rays, Shading::kPerLeaf),
      resolver(device, rays, picture, &ranges),
      blank(device, "blank picture", picture.bytes, MemoryKind::kDevice) {}

DirectPath::DirectPath(const Device& device, const Field& field, const RayBatch& rays)
    : live(device, field, 1),
      finder(device, field, live),
      direct(device, field, live, rays),
      paper(device, field, live, rays, Walk::kFromRoot) {}

namespace {

// Settings whose pictures of nothing are the same.
bool same_blank(const FrameSettings& a, const FrameSettings& b) {
    return a.width == b.width && a.height == b.height && a.samples == b.samples && a.resolve == b.resolve;
}

}  // namespace

void record_tree(Commands& commands, FrameRenderer& r, const ShaderCamera& camera, const FrameSettings& settings) {
    TreePath& path = *r.tree_;
    if (!path.blank_settings || !same_blank(*path.blank_settings, settings)) {
        record_clear(commands, r.rays_);
        record_resolve(commands, r.resolver_, settings.width, settings.height, settings.samples, settings.resolve);
        copy(commands, r.picture_, path.blank, path.blank.bytes);
        path.blank_settings = settings;
    }
    if (path.frame != settings.frame) record_slice_tree(commands, path.slicer, settings.frame);
    path.frame = settings.frame;
    const bool shaded = settings.mode == TraceMode::kShaded;
    if (shaded) record_shade(commands, path.shader, glm::vec3(camera.origin));
    record_tile_ranges(commands, path.ranger, camera);
    record_trace_tree(commands, shaded ? path.shaded_tracer : path.unshaded_tracer, r.rays_, settings.stop);
    copy(commands, path.blank, r.picture_, path.blank.bytes);
    compute_barrier(commands);
    record_resolve(commands, path.resolver, settings.width, settings.height, settings.samples, settings.resolve);
}

void record_frame(Commands& commands, FrameRenderer& r, const ShaderCamera& camera, const FrameSettings& settings) {
    const uint32_t tiles = tile_count(settings.samples * settings.width, settings.samples * settings.height);
    switch (settings.mode) {
        case TraceMode::kShaded:
        case TraceMode::kTree: record_tree(commands, r, camera, settings); break;
        case TraceMode::kSlice:
            record_slice(commands, r.slots_->slicer, settings.frame);
            record_trace(commands, r.slots_->tracer, tiles, settings.stop);
            break;
        case TraceMode::kDirect:
        case TraceMode::kPaper:
            record_rows(commands, r.direct_->finder, settings.frame);
            record_direct(commands, settings.mode == TraceMode::kPaper ? r.direct_->paper : r.direct_->direct, tiles,
                          settings.stop);
            break;
    }
    if (settings.mode != TraceMode::kShaded && settings.mode != TraceMode::kTree)
        record_resolve(commands, r.resolver_, settings.width, settings.height, settings.samples, settings.resolve);
    copy(commands, r.picture_, r.readback_, uint64_t{4} * settings.width * settings.height);
    host_barrier(commands);
}

FrameRenderer::FrameRenderer(const Device& device, const Field& field, uint32_t max_width, uint32_t max_height,
                             uint32_t max_samples)
    : device_(device),
      field_(field),
      rays_(device, 1, checked_tiles(device, max_width, max_height, max_samples)),
      picture_(device, "picture", uint64_t{4} * max_width * max_height, MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "picture readback", uint64_t{4} * max_width * max_height, MemoryKind::kReadback),
      resolver_(device, rays_, picture_),
      commands_(device, "frame") {}

void FrameRenderer::prepare(TraceMode mode) {
    switch (mode) {
        case TraceMode::kShaded:
        case TraceMode::kTree:
            if (!tree_) tree_ = std::make_unique<TreePath>(device_, field_, rays_, picture_);
            break;
        case TraceMode::kSlice:
            if (!slots_) slots_ = std::make_unique<SlotPath>(device_, field_, rays_);
            break;
        case TraceMode::kDirect:
        case TraceMode::kPaper:
            if (!direct_) direct_ = std::make_unique<DirectPath>(device_, field_, rays_);
            break;
    }
}

void FrameRenderer::forget_slice() {
    if (tree_) tree_->frame.reset();
}

Image FrameRenderer::render(const Camera& camera, const FrameSettings& settings) {
    const std::vector<Tile> tiles =
        tiles_of_picture(0, settings.samples * settings.width, settings.samples * settings.height);
    Image image(settings.width, settings.height);
    if (tiles.size() > rays_.tile_capacity || image.rgba.size() > readback_.bytes)
        throw RuntimeFailure(
            fmt::format("a picture of {}x{} is larger than its renderer", settings.width, settings.height));
    prepare(settings.mode);
    const ShaderCamera seen = shader_camera(enlarged(camera, settings.samples), settings.samples);
    *rays_.cameras.as<ShaderCamera>() = seen;
    std::memcpy(rays_.tiles.mapped, tiles.data(), tiles.size() * sizeof(Tile));
    commands_.begin();
    record_frame(commands_, *this, seen, settings);
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
