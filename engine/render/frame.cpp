#include "render/frame.h"

#include <fmt/format.h>

#include <algorithm>
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
    // Half a leaf as seen from the eye, in radians. Functions of degree n turn n times as fast as those of degree 1.
    constexpr float kSmallAngle = 0.02f;
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    const float half_leaf = 0.5f * field.leaf_diagonal * static_cast<float>(field.hh_degree);
    return half_leaf < kSmallAngle * glm::length(outside) ? TraceMode::kShaded : TraceMode::kTree;
}

SlotPath::SlotPath(const Device& device, const Field& field, const RayBatch& rays)
    : slice(device, field, field.leaf_count), slicer(device, field, slice), tracer(device, field, slice, rays) {}

TreePath::TreePath(const Device& device, const Field& field, const RayBatch& rays, const Buffer& picture,
                   uint32_t entries, uint64_t slice_budget)
    : live(device, field, field.leaf_count),
      trees(device, field, entries,
            static_cast<uint32_t>(std::clamp<uint64_t>(slice_budget / slice_bytes(field, entries), 1, field.frames))),
      shaded(shaded_entries(device, trees.capacity)),
      ranges(device, rays.tile_capacity),
      slicer(device, field, live, trees),
      shader(device, field, trees, shaded),
      ranger(device, field, trees, ranges),
      unshaded_tracer(device, field, trees, trees.entries, ranges, rays, Shading::kPerRay),
      shaded_tracer(device, field, trees, shaded, ranges, rays, Shading::kPerLeaf),
      resolver(device, rays, picture, &ranges),
      blank(device, "blank picture", picture.bytes, MemoryKind::kDevice),
      kept(trees.slices),
      count_readback(device, "entries readback", sizeof(LiveCount), MemoryKind::kReadback) {}

TreePath::Place TreePath::place_of(float frame) {
    pictures++;
    auto found = std::find_if(kept.begin(), kept.end(), [frame](const Kept& one) { return one.frame == frame; });
    const bool built = found != kept.end();
    if (!built)
        found =
            std::min_element(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.asked < b.asked; });
    *found = {frame, pictures};
    return {static_cast<uint32_t>(found - kept.begin()), built};
}

DirectPath::DirectPath(const Device& device, const Field& field, const RayBatch& rays)
    : live(device, field, 1),
      finder(device, field, live),
      direct(device, field, live, rays),
      paper(device, field, live, rays, Walk::kFromRoot) {}

namespace {

bool is_of_tree(TraceMode mode) {
    return mode == TraceMode::kShaded || mode == TraceMode::kTree;
}

// A part of a clip's leaves live in one of its frames, all those of a still.
uint32_t likely_entries(const Field& field) {
    const uint32_t most = most_entries(field);
    return field.frames == 1 ? most : std::min(most, most / 4 + 4096);
}

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
    const auto [slice, built] = path.place_of(settings.frame);
    if (!built) record_slice_tree(commands, path.slicer, slice, settings.frame);
    copy(commands, path.trees.counts, path.count_readback, sizeof(LiveCount), slice * sizeof(LiveCount));
    const bool shaded = settings.mode == TraceMode::kShaded;
    if (shaded) record_shade(commands, path.shader, slice, glm::vec3(camera.origin));
    record_tile_ranges(commands, path.ranger, slice, camera);
    record_trace_tree(commands, shaded ? path.shaded_tracer : path.unshaded_tracer, slice, r.rays_, settings.stop);
    copy(commands, path.blank, r.picture_, path.blank.bytes);
    compute_barrier(commands);
    record_resolve(commands, path.resolver, settings.width, settings.height, settings.samples, settings.resolve);
}

void record_frame(Commands& commands, FrameRenderer& r, const ShaderCamera& camera, const FrameSettings& settings) {
    const uint32_t tiles = tile_count(settings.samples * settings.width, settings.samples * settings.height);
    switch (settings.mode) {
        case TraceMode::kShaded:
        case TraceMode::kTree:
            record_tree(commands, r, camera, settings);
            break;
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
    if (!is_of_tree(settings.mode))
        record_resolve(commands, r.resolver_, settings.width, settings.height, settings.samples, settings.resolve);
    copy(commands, r.picture_, r.readback_, uint64_t{4} * settings.width * settings.height);
    host_barrier(commands);
}

FrameRenderer::FrameRenderer(const Device& device, const Field& field, uint32_t max_width, uint32_t max_height,
                             uint32_t max_samples, uint64_t slice_budget)
    : device_(device),
      field_(field),
      slice_budget_(slice_budget),
      rays_(device, 1, checked_tiles(device, max_width, max_height, max_samples)),
      picture_(device, "picture", uint64_t{4} * max_width * max_height, MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "picture readback", uint64_t{4} * max_width * max_height, MemoryKind::kReadback),
      resolver_(device, rays_, picture_),
      commands_(device, "frame") {}

void FrameRenderer::prepare(TraceMode mode) {
    switch (mode) {
        case TraceMode::kShaded:
        case TraceMode::kTree:
            if (!tree_)
                tree_ =
                    std::make_unique<TreePath>(device_, field_, rays_, picture_, likely_entries(field_), slice_budget_);
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

// Whether the last picture's slice had more entries than there was room for; then there is more for the next.
bool FrameRenderer::enlarge_slices() {
    if (!tree_ || tree_->count_readback.as<LiveCount>()->overflow == 0) return false;
    const uint32_t entries = std::min(most_entries(field_), 2 * tree_->trees.capacity);
    tree_.reset();  // before there is another
    tree_ = std::make_unique<TreePath>(device_, field_, rays_, picture_, entries, slice_budget_);
    return true;
}

void FrameRenderer::forget_slices() {
    if (tree_) std::fill(tree_->kept.begin(), tree_->kept.end(), TreePath::Kept{});
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
    do {
        commands_.begin();
        record_frame(commands_, *this, seen, settings);
        commands_.submit();
        commands_.wait();
    } while (is_of_tree(settings.mode) && enlarge_slices());
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
