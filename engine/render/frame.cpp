#include "render/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/error.h"

namespace neuvv {

namespace {

constexpr uint32_t kMaxScopes = 8 * kMaxInstances + 64;  // five of a slice, three of an instance, and the rest

// Tiles of all views' rays. Throws RuntimeFailure where the device cannot address so many rays.
uint32_t checked_tiles(const Device& device, const FrameCapacity& capacity) {
    const uint64_t across = (uint64_t{capacity.samples} * capacity.width + kTile - 1) / kTile;
    const uint64_t down = (uint64_t{capacity.samples} * capacity.height + kTile - 1) / kTile;
    const uint64_t tiles = across * down * capacity.views;
    if (tiles * kTilePixels > device.limits().maxTexelBufferElements)
        throw RuntimeFailure(
            fmt::format("{}x{} pixels of {} rays are too many for this device; choose a smaller --size "
                        "or --samples",
                        capacity.width, capacity.height, capacity.samples * capacity.samples));
    return static_cast<uint32_t>(tiles);
}

ViewLayout largest(const FrameCapacity& capacity) {
    return {capacity.width, capacity.height, capacity.samples, capacity.views};
}

// Per-ray values of one view from tile order into rows.
template <typename T>
std::vector<T> rows_of_view(const Device& device, const Buffer& rays, const ViewLayout& layout, uint32_t view) {
    std::vector<T> tiles(size_t{layout.ray_tiles()} * kTilePixels);
    download(device, rays, tiles.data(), tiles.size() * sizeof(T));
    const uint32_t width = layout.rays_across(), height = layout.rays_down();
    const size_t first_tile = size_t{view} * layout.tiles_across() * layout.tiles_down();
    std::vector<T> rows(size_t{width} * height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t tile = first_tile + size_t{y / kTile} * layout.tiles_across() + x / kTile;
            rows[size_t{y} * width + x] = tiles[tile * kTilePixels + y % kTile * kTile + x % kTile];
        }
    return rows;
}

bool is_reference(TraceMode mode) {
    return mode == TraceMode::kSlice || mode == TraceMode::kDirect || mode == TraceMode::kPaper;
}

// World, metres.
glm::dvec3 middle_of(const Field& field, const Instance& instance) {
    const glm::dvec4 middle(0.5 * glm::dvec3(field.leaves_min + field.leaves_max), 1);
    return glm::dvec3(glm::dmat4(instance.world_from_performer) * middle);
}

}  // namespace

SlotPath::SlotPath(const Device& device, const Field& field, const RayBatch& rays)
    : slice(device, field, field.leaf_count), slicer(device, field, slice), tracer(device, field, slice, rays) {}

DirectPath::DirectPath(const Device& device, const Field& field, const RayBatch& rays)
    : live(device, field, 1),
      finder(device, field, live),
      direct(device, field, live, rays),
      paper(device, field, live, rays, Walk::kFromRoot) {}

void record_instances(Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    ViewLayout all_pixels = r.layout_;
    all_pixels.rays = {};
    const std::pair shown(all_pixels, settings.resolve);
    if (r.blank_is_of_ != shown) {
        record_clear(commands, r.rays_, all_pixels.ray_tiles());
        record_resolve(commands, r.resolver_, all_pixels, settings.resolve);
        copy(commands, r.picture_, r.blank_, r.layout_.picture_bytes());
        r.blank_is_of_ = shown;
    }
    record_clear(commands, r.rays_, r.layout_.ray_tiles());
    record_slices(commands, *r.performer_);
    record_unseen(commands, r.ranges_);
    for (const DrawnInstance& instance : r.drawn_)
        record_instance(commands, *r.performer_, instance, r.layout_, settings.stop);
    record_picture_list(commands, r.lister_, r.layout_);
    {
        const PassScope scope(commands, "blank");
        copy(commands, r.blank_, r.picture_, r.layout_.picture_bytes());
        compute_barrier(commands);
    }
    if (r.layout_.upscaled())
        record_upscale(commands, *r.upscaler_, r.layout_, settings.resolve);
    else
        record_resolve(commands, r.listed_resolver_, r.layout_, settings.resolve);
    record_slices_ahead(commands, *r.performer_, settings.parts_ahead);
}

void record_frame(Commands& commands, FrameRenderer& r, const FrameSettings& settings) {
    const uint32_t tiles = r.layout_.ray_tiles();
    const float frame = settings.instances.empty() ? 0 : settings.instances[0].frame;  // a reference has only this one
    switch (settings.mode) {
        case TraceMode::kPlay:
        case TraceMode::kShaded:
        case TraceMode::kTree:
            record_instances(commands, r, settings);
            break;
        case TraceMode::kSlice:
            record_slice(commands, r.slots_->slicer, frame);
            record_trace(commands, r.slots_->tracer, tiles, settings.stop);
            break;
        case TraceMode::kDirect:
        case TraceMode::kPaper:
            record_rows(commands, r.direct_->finder, frame);
            record_direct(commands, settings.mode == TraceMode::kPaper ? r.direct_->paper : r.direct_->direct, tiles,
                          settings.stop);
            break;
    }
    if (is_reference(settings.mode)) record_resolve(commands, r.resolver_, r.layout_, settings.resolve);
    const PassScope scope(commands, "readback");
    copy(commands, r.picture_, r.readback_, r.layout_.picture_bytes());
    host_barrier(commands);
}

FrameRenderer::FrameRenderer(const Device& device, const Field& field, const FrameCapacity& capacity)
    : device_(device),
      field_(field),
      capacity_(capacity),
      paints_(device, field),
      rays_(device, capacity.views * (kMaxInstances + 1), checked_tiles(device, capacity)),
      ranges_(device, rays_.tile_capacity, largest(capacity).picture_tiles(), rays_.camera_capacity),
      picture_(device, "picture", largest(capacity).picture_bytes(), MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "picture readback", largest(capacity).picture_bytes(), MemoryKind::kReadback),
      blank_(device, "blank picture", largest(capacity).picture_bytes(), MemoryKind::kDevice),
      lister_(device, rays_, ranges_),
      resolver_(device, rays_, picture_),
      listed_resolver_(device, rays_, picture_, &ranges_),
      commands_(device, "frame", kMaxScopes) {}

void FrameRenderer::expect_fitting(std::span<const Camera> cameras, const FrameSettings& settings) const {
    const ViewLayout layout{settings.width, settings.height, settings.samples, static_cast<uint32_t>(cameras.size())};
    if (layout.ray_tiles() > rays_.tile_capacity || cameras.size() > capacity_.views ||
        layout.picture_tiles() > ranges_.picture_tile_capacity || layout.picture_bytes() > readback_.bytes)
        throw RuntimeFailure(fmt::format("{} pictures of {}x{} are more than their renderer was made for", layout.views,
                                         settings.width, settings.height));
    if (settings.instances.size() > kMaxInstances)
        throw RuntimeFailure(fmt::format("{} instances are more than a frame shows; leave {}",
                                         settings.instances.size(), kMaxInstances));
    for (const Camera& camera : cameras)
        if (camera.width != settings.width || camera.height != settings.height)
            throw RuntimeFailure(fmt::format("a camera of {}x{} pixels for a picture of {}x{}", camera.width,
                                             camera.height, settings.width, settings.height));
    assert(!is_reference(settings.mode) || (layout.views == 1 && settings.instances.size() == 1));
    assert(!is_reference(settings.mode) || settings.instances[0].paint == 0);
    assert(settings.scale > 0 && settings.scale <= 1);
    assert(settings.foveae.empty() || settings.foveae.size() == cameras.size());
    for (size_t i = 0; i < settings.instances.size(); i++) {
        const double volume = glm::determinant(glm::dmat3(settings.instances[i].world_from_performer));
        if (!std::isfinite(volume) || volume == 0)
            throw RuntimeFailure(fmt::format("instance {}: its transform cannot be inverted", i));
    }
}

// Where rays stand, and how many there are in each view: as many as in the one that has most.
void FrameRenderer::place_grids(const FrameSettings& settings, uint32_t views) {
    layout_ = {settings.width, settings.height, settings.samples, views};
    grids_.clear();
    if (settings.scale == 1 && settings.foveae.empty()) return;
    assert(settings.samples == 1 && !is_reference(settings.mode));
    for (uint32_t view = 0; view < views; view++) {
        const Fovea fovea = settings.foveae.empty() ? Fovea{} : settings.foveae[view];
        grids_.push_back(ray_grid(settings.width, settings.height, settings.scale, fovea));
        layout_.rays = glm::max(layout_.rays, grids_.back().rays);
    }
    if (!upscaler_) upscaler_ = std::make_unique<Upscaler>(device_, rays_, picture_, ranges_);
}

ShaderCamera FrameRenderer::shader_camera_of(const Camera& camera, uint32_t view) const {
    return layout_.upscaled() ? shader_camera(camera, grids_[view])
                              : shader_camera(enlarged(camera, layout_.samples), layout_.samples);
}

// The cameras of the world, one a view, and their tiles.
void FrameRenderer::place_rays(std::span<const Camera> cameras, const FrameSettings& settings) {
    const ViewLayout last = layout_;
    place_grids(settings, static_cast<uint32_t>(cameras.size()));
    for (uint32_t view = 0; view < layout_.views; view++)
        rays_.cameras.as<ShaderCamera>()[view] = shader_camera_of(cameras[view], view);
    if (layout_ == last) return;
    Tile* to = rays_.tiles.as<Tile>();
    for (uint32_t view = 0; view < layout_.views; view++) {
        const std::vector<Tile> tiles = tiles_of_picture(view, layout_.rays_across(), layout_.rays_down());
        to = std::copy(tiles.begin(), tiles.end(), to);
    }
}

// Those that may be seen, near to far, so that rays that have met something solid need not look behind it.
void FrameRenderer::place_instances(std::span<const Camera> cameras, const FrameSettings& settings) {
    glm::dvec3 eye(0);
    for (const Camera& camera : cameras)
        eye += glm::dvec3(camera.world_from_camera[3]) / static_cast<double>(cameras.size());
    std::vector<std::pair<double, uint32_t>> by_distance;
    for (uint32_t i = 0; i < settings.instances.size(); i++)
        by_distance.emplace_back(glm::distance(eye, middle_of(field_, settings.instances[i])), i);
    std::sort(by_distance.begin(), by_distance.end());
    drawn_.clear();
    for (const auto& [distance, i] : by_distance) place_instance(cameras, settings, settings.instances[i]);
}

void FrameRenderer::place_instance(std::span<const Camera> cameras, const FrameSettings& settings,
                                   const Instance& instance) {
    DrawnInstance drawn;
    drawn.frame = std::clamp(instance.frame, 0.0f, static_cast<float>(field_.frames - 1));
    drawn.paint = instance.paint;
    drawn.first_camera = layout_.views * (static_cast<uint32_t>(drawn_.size()) + 1);
    drawn.shading = settings.mode == TraceMode::kTree ? Shading::kPerRay : Shading::kPerLeaf;
    const double pixel_rays = settings.samples * settings.scale;  // along each side
    bool seen_at_all = false;
    for (uint32_t view = 0; view < layout_.views; view++) {
        const Camera camera = in_performer(cameras[view], instance.world_from_performer);
        const glm::vec3 eye(camera.world_from_camera[3]);
        const ShaderCamera seen = shader_camera_of(camera, view);
        const RangeView range = range_view(seen);
        const glm::dvec2 picture = static_cast<double>(settings.samples) * glm::dvec2(camera.width, camera.height);
        const double rays =
            pixels_around(range, picture, field_.leaves_min, field_.leaves_max) * settings.scale * settings.scale;
        rays_.cameras.as<ShaderCamera>()[drawn.first_camera + view] = seen;
        ranges_.views.as<RangeView>()[drawn.first_camera + view] = range;
        const uint32_t level = range_level(field_, eye, pixel_rays * std::max(camera.fx, camera.fy));
        drawn.range_level = std::max(drawn.range_level, level);
        if (settings.mode == TraceMode::kPlay && play_shading(field_, eye, rays) == Shading::kPerRay)
            drawn.shading = Shading::kPerRay;
        seen_at_all |= rays > 0;
    }
    if (seen_at_all) drawn_.push_back(drawn);
}

void FrameRenderer::prepare(const FrameSettings& settings) {
    switch (settings.mode) {
        case TraceMode::kPlay:
        case TraceMode::kShaded:
        case TraceMode::kTree:
            if (!performer_)
                performer_ = std::make_unique<Performer>(device_, field_, paints_, rays_, ranges_, capacity_.views,
                                                         capacity_.slice_budget);
            performer_->prepare(drawn_, settings.next_slices);
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

void FrameRenderer::forget_slices() {
    if (performer_ && performer_->slices()) performer_->slices()->cache.forget();
}

std::vector<Image> FrameRenderer::render_views(std::span<const Camera> cameras, const FrameSettings& settings) {
    expect_fitting(cameras, settings);
    place_rays(cameras, settings);
    place_instances(cameras, settings);
    do {
        prepare(settings);
        commands_.begin();
        record_frame(commands_, *this, settings);
        commands_.submit();
        commands_.wait();
    } while (!is_reference(settings.mode) && performer_->enlarge_slices());
    std::vector<Image> pictures;
    const uint8_t* from = readback_.as<uint8_t>();
    for (size_t view = 0; view < cameras.size(); view++) {
        Image& picture = pictures.emplace_back(settings.width, settings.height);
        std::memcpy(picture.rgba.data(), from, picture.rgba.size());
        from += picture.rgba.size();
    }
    return pictures;
}

Image FrameRenderer::render(const Camera& camera, const FrameSettings& settings) {
    return std::move(render_views({&camera, 1}, settings)[0]);
}

std::vector<glm::vec4> FrameRenderer::radiance(uint32_t view) const {
    return rows_of_view<glm::vec4>(device_, rays_.radiance, layout_, view);
}

std::vector<float> FrameRenderer::depth(uint32_t view) const {
    return rows_of_view<float>(device_, rays_.depth, layout_, view);
}

}  // namespace neuvv
