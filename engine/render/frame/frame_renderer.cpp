// FrameRenderer: creates and fills what a frame needs on the device. Recording is in frame.cpp, submitting in
// frame_submit.cpp.
#include "render/frame/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace neuvv::render {

namespace {

// Three scopes for an instance, three more for its highlight, and five for its slice, for the views and again for the
// lights, and the other passes.
constexpr uint32_t kMaxScopes = 22 * kMaxInstances + 64;

ViewLayout largest(const FrameCapacity& capacity) {
    return {capacity.width, capacity.height, capacity.samples, capacity.views};
}

const SetTargets* targets_of(const SetRaster* set) {
    return set ? &set->targets() : nullptr;
}

SetBuffers set_buffers_of(const SetRaster* set) {
    if (!set) return {};
    const SetLighting& lighting = set->lighting;
    return {&set->targets().depth, &lighting.lights_buffer, &lighting.set_shadow_maps, &lighting.performer_shadows};
}

// The instance as an inspection draws it: not merged with others, without set and lights.
DrawnInstance inspected(DrawnInstance instance) {
    instance.shading = Shading::kNone;
    instance.output = RayOutput::kInspect;
    instance.rays.set_size = {};
    instance.rays.lighting = 0;
    instance.highlight.reset();
    return instance;
}

constexpr uint32_t kMaxMerges = 4 * kMaxInstances;  // groups of instances, times bands

}  // namespace

FrameRenderer::FrameRenderer(const gpu::Device& device, std::vector<const Field*> fields, const FrameCapacity& capacity,
                             SetRaster* set)
    : device_(device),
      capacity_(capacity),
      set_(set),
      target_(device, capacity.views * (kMaxInstances + 1), checked_ray_tiles(device, largest(capacity)),
              largest(capacity).image_tiles(), set_buffers_of(set)),
      image_(device, "image", largest(capacity).image_bytes(), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "image readback", largest(capacity).image_bytes(), gpu::MemoryKind::kReadback),
      clearer_(device, target_),
      slices_(device, std::move(fields), capacity.slice_budget),
      lister_(device, target_.rays, target_.ranges),
      resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, nullptr, targets_of(set)),
      listed_resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, &target_.ranges),
      queue_(device, kMaxScopes) {
    if (!set) return;
    assert(set->targets().views() >= capacity.views);
    shadows_ = std::make_unique<PerformerShadows>(device, set->lighting, kMaxInstances);
    volume_depth_ = std::make_unique<VolumeDepth>(device, target_.rays, set->targets());
}

FrameRenderer::FrameRenderer(FrameRenderer&& other, const FrameCapacity& capacity)
    : FrameRenderer(other.device_, other.slices_.fields(), capacity, other.set_) {
    other.finish();
    picks_.take_over(other.picks_);
    shadows_ = std::move(other.shadows_);
    slices_.take_over(other.slices_, performer_targets()[kEyeTarget]);
}

std::vector<PerformerTarget> FrameRenderer::performer_targets() const {
    std::vector<PerformerTarget> targets{{&target_, capacity_.views}};
    if (shadows_) targets.push_back({&shadows_->target, kMaxShadows});
    return targets;
}

void FrameRenderer::change_fields(std::vector<const Field*> fields, uint32_t shares) {
    if (shares == 0) shares = static_cast<uint32_t>(fields.size());
    if (slices_.has_fields(fields, shares)) return;
    finish();
    slices_.change_fields(std::move(fields), shares);
    inspector_.reset();
    drawn_.clear();
}

void FrameRenderer::check_settings(std::span<const stage::Camera> cameras, const FrameSettings& settings) const {
    const ViewLayout layout{settings.width, settings.height, settings.samples, static_cast<uint32_t>(cameras.size())};
    if (layout.ray_tiles() > target_.rays.tile_capacity || cameras.size() > capacity_.views ||
        layout.image_tiles() > target_.ranges.image_tile_capacity || layout.image_bytes() > readback_.bytes)
        throw RuntimeFailure(fmt::format("{} images of {}x{} are more than their renderer was made for", layout.views,
                                         settings.width, settings.height));
    if (set_ && (layout.samples * layout.width > set_->targets().width ||
                 layout.samples * layout.height > set_->targets().height))
        throw RuntimeFailure(fmt::format("{}x{} pixels of {} rays are more than the set's {}x{} texels", layout.width,
                                         layout.height, layout.samples * layout.samples, set_->targets().width,
                                         set_->targets().height));
    if (settings.instances.size() > kMaxInstances)
        throw RuntimeFailure(fmt::format("{} instances are more than a frame shows; leave {}",
                                         settings.instances.size(), kMaxInstances));
    for (const stage::Camera& camera : cameras)
        if (camera.width != settings.width || camera.height != settings.height)
            throw RuntimeFailure(fmt::format("a camera of {}x{} pixels for an image of {}x{}", camera.width,
                                             camera.height, settings.width, settings.height));
    assert(settings.scale > 0 && settings.scale <= 1);
    assert(settings.foveae.empty() || settings.foveae.size() == cameras.size());
    for (size_t i = 0; i < settings.instances.size(); ++i) {
        const double volume = glm::determinant(glm::dmat3(settings.instances[i].world_from_performer));
        if (!std::isfinite(settings.instances[i].frame))
            throw RuntimeFailure(fmt::format("instance {}: its frame is not finite", i));
        if (!std::isfinite(volume) || volume == 0)
            throw RuntimeFailure(fmt::format("instance {}: its transform cannot be inverted", i));
        if (settings.instances[i].field >= slices_.levels().given())
            throw RuntimeFailure(fmt::format("instance {}: there is no field {}", i, settings.instances[i].field));
    }
}

// Sets the ray grids of the views, and the number of rays of a view, which is that of the view with the most rays.
void FrameRenderer::make_grids(const FrameSettings& settings, uint32_t views) {
    const bool upscaled = settings.scale != 1 || !settings.foveae.empty();
    if (upscaled && !upscaler_)  // first, as it may find no memory: then the tiles are still those of layout_
        upscaler_ = std::make_unique<Resolver>(device_, RaysPerPixel::kFewer, target_.rays, image_,
                                               set_ ? nullptr : &target_.ranges, targets_of(set_));
    layout_ = {settings.width, settings.height, settings.samples, views};
    grids_.clear();
    if (!upscaled) return;
    assert(settings.samples == 1);
    for (uint32_t view = 0; view < views; ++view) {
        const Fovea fovea = settings.foveae.empty() ? Fovea{} : settings.foveae[view];
        grids_.push_back(ray_grid(settings.width, settings.height, settings.scale, fovea));
        layout_.rays = glm::max(layout_.rays, grids_.back().rays);
    }
}

TargetViews FrameRenderer::views_of(std::span<const stage::Camera> cameras, const FrameSettings& settings) {
    return {target_, layout_, cameras, grids_, settings.scale};
}

// Writes the cameras of the views and their tiles.
void FrameRenderer::write_rays(std::span<const stage::Camera> cameras, const FrameSettings& settings) {
    const ViewLayout last = layout_;
    make_grids(settings, static_cast<uint32_t>(cameras.size()));
    write_cameras(views_of(cameras, settings));
    if (layout_ != last) {
        wait_for_device();
        write_tiles(views_of(cameras, settings));
    }
    set_cameras_.clear();
    for (const stage::Camera& camera : cameras) set_cameras_.push_back(stage::enlarged(camera, layout_.samples));
}

// Groups of instances, near to far, so that rays end at the first solid surface.
std::vector<std::vector<uint32_t>> FrameRenderer::instance_order(std::span<const stage::Camera> cameras,
                                                                 const FrameSettings& settings) const {
    std::vector<glm::dvec3> eyes;
    for (const stage::Camera& camera : cameras) eyes.emplace_back(camera.world_from_camera[3]);
    std::vector<TransformedBox> boxes;
    for (const Instance& instance : settings.instances) {
        const Field& field = *slices_.levels().all[instance.field];
        boxes.push_back(transformed_box(field.leaves_min, field.leaves_max, instance.world_from_performer));
    }
    if (settings.blend == Blend::kExact) return draw_order(boxes, eyes);
    glm::dvec3 eye(0);
    for (const glm::dvec3& one : eyes) eye += one / static_cast<double>(eyes.size());
    std::vector<std::pair<double, uint32_t>> by_distance;
    for (uint32_t i = 0; i < boxes.size(); ++i) by_distance.emplace_back(glm::distance(eye, boxes[i].centre), i);
    std::sort(by_distance.begin(), by_distance.end());
    std::vector<std::vector<uint32_t>> order;
    for (const auto& [distance, i] : by_distance) order.push_back({i});
    return order;
}

// Writes the cameras of the visible instances and fills drawn_.
void FrameRenderer::write_instances(std::span<const stage::Camera> cameras, const FrameSettings& settings) {
    drawn_.clear();
    uint32_t placed = 0;
    for (const std::vector<uint32_t>& group : instance_order(cameras, settings)) {
        std::vector<DrawnInstance> drawn;
        for (const uint32_t i : group) {
            const Instance& instance = settings.instances[i];
            auto one = write_instance_cameras(views_of(cameras, settings), *slices_.levels().all[instance.field],
                                              instance, placed);
            if (!one) continue;
            if (settings.mode == TraceMode::kTree) one->shading = Shading::kPerRay;
            if (settings.mode == TraceMode::kShaded) one->shading = Shading::kPerLeaf;
            one->highlight = instance.highlight;
            one->performer = instance.performer;
            if (instance.highlight) one->shading = Shading::kPerLeaf;
            one->output = settings.blend == Blend::kPaper ? RayOutput::kLayerByDepth : RayOutput::kLayer;
            one->rays.stop = settings.stop;
            if (set_) one->rays.set_size = layout_.samples * glm::uvec2(layout_.width, layout_.height);
            if (set_ && settings.lit) one->rays.lighting = kLit | (instance.receives_shadow ? kShadowed : 0u);
            ++placed;
            if (is_inspection(settings.resolve.show))
                drawn_.push_back({inspected(*one)});
            else
                drawn.push_back(*one);
        }
        if (drawn.size() > 1)
            for (DrawnInstance& instance : drawn) instance.output = RayOutput::kIntervals;
        if (!drawn.empty()) drawn_.push_back(std::move(drawn));
    }
    if (shadows_) shadows_->prepare(slices_.levels(), settings.instances);
}

// Those of highlighted instances come first, as they need slices, and those of shadows last, as a missing slice matters
// less there.
SliceRequests FrameRenderer::slice_requests(std::span<const Instance> next) const {
    const size_t fields = slices_.levels().all.size();
    SliceRequests requests{std::vector<std::vector<SliceKey>>(fields), std::vector<std::vector<SliceKey>>(fields)};
    for (const bool highlighted : {true, false})
        for (const auto& group : drawn_)
            for (const DrawnInstance& instance : group)
                if ((instance.highlight != nullptr) == highlighted)
                    requests.now[instance.field].push_back(instance.slice());
    if (shadows_)
        for (const DrawnInstance& instance : shadows_->drawn) requests.now[instance.field].push_back(instance.slice());
    for (const Instance& one : next)
        if (one.field < fields) requests.next[one.field].push_back({one.frame, one.paint});
    return requests;
}

void FrameRenderer::prepare(const FrameSettings& settings) {
    if (is_inspection(settings.resolve.show) && !inspector_)
        inspector_ = std::make_unique<Inspector>(device_, target_.rays, image_, slices_.fields());
    const SliceRequests requests = slice_requests(settings.next_instances);
    if (slices_.replaces(requests)) wait_for_device();
    slices_.request(requests);
    const auto performers = slices_.performers();
    if (shadows_)
        for (const DrawnInstance& instance : shadows_->drawn)
            performers[instance.field]->prepare(kLightTarget, instance, nullptr);
    for (const auto& group : drawn_) {
        if (group.size() > 1) intervals();
        for (const DrawnInstance& instance : group)
            performers[instance.field]->prepare(kEyeTarget, instance, intervals_.get());
    }
}

Intervals& FrameRenderer::intervals() {
    if (!intervals_) intervals_ = std::make_unique<Intervals>(device_, target_, kMaxMerges, capacity_.interval_budget);
    return *intervals_;
}

bool FrameRenderer::begin_pick(const Instance& instance, std::span<const PickRay> rays, float alpha) {
    const auto [performer, slice] = slices_.nearest_built(instance, kPickedNear);
    if (performer) picks_.begin(*performer, slice, rays, alpha);
    return performer != nullptr;
}

bool FrameRenderer::drop_slices() {
    wait_for_device();
    queue_.forget();
    return slices_.drop();
}

// For a handler of the error.
void FrameRenderer::drop_slices_or_rethrow(const gpu::VulkanError& error) {
    if (error.device_lost()) throw;
    wait_for_device();
    queue_.forget();
    if (!slices_.drop_after(error)) throw;
}

void FrameRenderer::forget_slices() {
    finish();
    slices_.forget();
}

// Writes what the host writes for an image, creates what it needs on the device, and returns its settings with the
// levels at which instances are drawn.
FrameSettings FrameRenderer::begin(std::span<const stage::Camera> cameras, const FrameSettings& given) {
    if (!slices_.ensure_performers(performer_targets(), given.far_levels)) {
        wait_for_device();
        slices_.free_far_levels();
    }
    FrameSettings settings = given;
    slices_.choose_far_levels(cameras, settings);
    write_rays(cameras, settings);
    write_instances(cameras, settings);
    prepare(settings);
    return settings;
}

FrameSettings FrameRenderer::begin_with_memory_left(std::span<const stage::Camera> cameras,
                                                    const FrameSettings& settings) {
    for (;;) {
        try {
            return begin(cameras, settings);
        } catch (const gpu::VulkanError& error) {
            drop_slices_or_rethrow(error);
        }
    }
}

std::vector<glm::vec4> FrameRenderer::radiance(uint32_t view) const {
    assert(!queue_.any_under_way() && "finish() first");
    return rows_of_view<glm::vec4>(device_, target_.rays.radiance, layout_, view);
}

std::vector<float> FrameRenderer::depth(uint32_t view) const {
    assert(!queue_.any_under_way() && "finish() first");
    return rows_of_view<float>(device_, target_.rays.depth, layout_, view);
}

}  // namespace neuvv::render
