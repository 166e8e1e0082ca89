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
      levels_(std::move(fields)),
      slice_shares_(levels_.given()),
      capacity_(capacity),
      set_(set),
      target_(device, capacity.views * (kMaxInstances + 1), checked_ray_tiles(device, largest(capacity)),
              largest(capacity).image_tiles(), set_buffers_of(set)),
      image_(device, "image", largest(capacity).image_bytes(), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      readback_(device, "image readback", largest(capacity).image_bytes(), gpu::MemoryKind::kReadback),
      clearer_(device, target_),
      lister_(device, target_.rays, target_.ranges),
      resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, nullptr, targets_of(set)),
      listed_resolver_(device, RaysPerPixel::kWhole, target_.rays, image_, &target_.ranges),
      queue_(device, kMaxScopes) {
    capacity_.slice_budget = render::slice_budget(device.memory(), capacity.slice_budget);
    for (const Field* field : levels_.all) paints_.push_back(std::make_unique<Paints>(device, *field));
    if (!set) return;
    assert(set->targets().views() >= capacity.views);
    shadows_ = std::make_unique<PerformerShadows>(device, set->lighting, kMaxInstances);
    volume_depth_ = std::make_unique<VolumeDepth>(device, target_.rays, set->targets());
}

FrameRenderer::FrameRenderer(FrameRenderer&& other, const FrameCapacity& capacity)
    : FrameRenderer(other.device_, {other.levels_.all.begin(), other.levels_.all.begin() + other.levels_.given()},
                    capacity, other.set_) {
    other.finish();
    picks_.take_over(other.picks_);
    slice_shares_ = other.slice_shares_;
    capacity_.slice_budget = other.capacity_.slice_budget;  // its slices are taken over
    paints_ = std::move(other.paints_);
    shadows_ = std::move(other.shadows_);
    performers_ = std::move(other.performers_);
    far_levels_fit_ = other.far_levels_fit_;
    for (const auto& performer : performers_)
        if (performer) performer->replace_target(kEyeTarget, target_, capacity_.views);
}

// Where each field's share of the budget changes, slices are created again.
void FrameRenderer::change_fields(std::vector<const Field*> fields, uint32_t shares) {
    if (shares == 0) shares = static_cast<uint32_t>(fields.size());
    const bool same_shares = slice_shares_ == shares;
    if (same_shares && std::ranges::equal(fields, std::span(levels_.all).first(levels_.given()))) return;
    finish();
    slice_shares_ = shares;
    FieldLevels next(std::move(fields));
    std::vector<std::unique_ptr<Paints>> paints(next.all.size());
    std::vector<std::unique_ptr<Performer>> performers(next.all.size());
    performers_.resize(levels_.all.size());
    for (size_t i = 0; i < next.all.size(); ++i) {
        const auto before = std::find(levels_.all.begin(), levels_.all.end(), next.all[i]);
        if (before == levels_.all.end()) {
            paints[i] = std::make_unique<Paints>(device_, *next.all[i]);
            continue;
        }
        const auto at = static_cast<size_t>(before - levels_.all.begin());
        paints[i] = std::move(paints_[at]);
        if (same_shares) performers[i] = std::move(performers_[at]);
    }
    inspector_.reset();
    drawn_.clear();
    performers_ = std::move(performers);  // before the paints that they refer to
    paints_ = std::move(paints);
    levels_ = std::move(next);
    far_levels_fit_.reset();
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
        if (settings.instances[i].field >= levels_.given())
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
        const Field& field = *levels_.all[instance.field];
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
            auto one =
                write_instance_cameras(views_of(cameras, settings), *levels_.all[instance.field], instance, placed);
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
    if (shadows_) shadows_->prepare(levels_, settings.instances);
}

std::unique_ptr<Performer> FrameRenderer::make_performer(uint32_t index) const {
    const Field &field = *levels_.all[index], &finest = levels_.finest(index);
    uint64_t share = slice_share(capacity_.slice_budget, slice_shares_);
    if (&field != &finest) share = slice_share_of_level(share, finest, field);
    auto performer = std::make_unique<Performer>(device_, field, *paints_[index], share);
    performer->add_target(target_, capacity_.views);
    if (shadows_) performer->add_target(shadows_->target, kMaxShadows);
    return performer;
}

// Creates the performers that do not exist yet: those of the given fields, and of all of their coarser levels, so that
// no later frame waits for one. Where memory is short although each has but one slice, the given fields alone have
// performers.
void FrameRenderer::make_performers(bool far_levels) {
    performers_.resize(levels_.all.size());
    for (uint32_t i = 0; i < levels_.given(); ++i)
        if (!performers_[i]) performers_[i] = make_performer(i);
    if (!far_levels || far_levels_fit_) return;
    try {
        for (uint32_t i = levels_.given(); i < levels_.all.size(); ++i)
            if (!performers_[i]) performers_[i] = make_performer(i);
        far_levels_fit_ = true;
    } catch (const RuntimeFailure& error) {
        const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&error);
        if (vulkan && (vulkan->device_lost() || capacity_.slice_budget > 1)) throw;
        far_levels_fit_ = false;
        wait_for_device();  // picks may read their slices
        for (uint32_t i = levels_.given(); i < levels_.all.size(); ++i) performers_[i].reset();
    }
}

void FrameRenderer::prepare(const FrameSettings& settings) {
    if (is_inspection(settings.resolve.show) && !inspector_)
        inspector_ =
            std::make_unique<Inspector>(device_, target_.rays, image_, std::span(levels_.all).first(levels_.given()));
    std::vector<std::vector<SliceKey>> slices(levels_.all.size()), next(levels_.all.size());
    for (const bool highlighted : {true, false})  // a highlight needs a slice
        for (const auto& group : drawn_)
            for (const DrawnInstance& instance : group)
                if ((instance.highlight != nullptr) == highlighted) slices[instance.field].push_back(instance.slice());
    if (shadows_)  // after those of the views, as a missing slice matters less in a shadow
        for (const DrawnInstance& instance : shadows_->drawn) slices[instance.field].push_back(instance.slice());
    for (const Instance& one : settings.next_instances)
        if (one.field < next.size()) next[one.field].push_back({one.frame, one.paint});
    for (size_t i = 0; i < performers_.size(); ++i) {
        if (!performers_[i]) continue;
        if (performers_[i]->replaces_slices(slices[i])) wait_for_device();
        performers_[i]->prepare(slices[i], next[i]);
    }
    if (shadows_)
        for (const DrawnInstance& instance : shadows_->drawn)
            performers_[instance.field]->prepare(kLightTarget, instance, nullptr);
    for (const auto& group : drawn_) {
        if (group.size() > 1) intervals();
        for (const DrawnInstance& instance : group)
            performers_[instance.field]->prepare(kEyeTarget, instance, intervals_.get());
    }
}

Intervals& FrameRenderer::intervals() {
    if (!intervals_) intervals_ = std::make_unique<Intervals>(device_, target_, kMaxMerges, capacity_.interval_budget);
    return *intervals_;
}

bool FrameRenderer::drop_slices() {
    wait_for_device();
    queue_.forget();
    uint64_t taken = 0;
    for (const auto& performer : performers_) {
        const SliceCache* slices = performer ? performer->slices() : nullptr;
        if (slices) taken += slices->trees().slices * slice_bytes(performer->field(), slices->trees().capacity);
    }
    if (taken > 0 && capacity_.slice_budget > 1)
        capacity_.slice_budget = std::max<uint64_t>(std::min(taken, capacity_.slice_budget) / 2, 1);
    performers_.clear();
    if (far_levels_fit_.value_or(false))
        far_levels_fit_.reset();  // where they did not fit, they stay out until fields change
    return taken > 0;
}

// For a handler of the error: performers may be incomplete, or none may exist because the first did not fit.
void FrameRenderer::drop_slices_or_rethrow(const gpu::VulkanError& error) {
    if (error.device_lost()) throw;
    const uint64_t before = capacity_.slice_budget;
    drop_slices();
    if (!error.out_of_memory() || before <= 1) throw;
    if (capacity_.slice_budget == before) capacity_.slice_budget = before / 2;
}

void FrameRenderer::forget_slices() {
    finish();
    for (const auto& performer : performers_)
        if (performer && performer->slices()) performer->slices()->forget();
}

uint64_t FrameRenderer::live_entries() const {
    uint64_t entries = 0;
    for (const auto& performer : performers_)
        if (performer) entries += performer->used_entries(queue_.slot());
    return entries;
}

// Makes the level at which an instance is drawn its field, also of the instances whose slices are prefetched.
void FrameRenderer::choose_far_levels(std::span<const stage::Camera> cameras, FrameSettings& settings) const {
    if (!settings.far_levels || !far_levels_fit_.value_or(false)) return;
    for (std::vector<Instance>* instances : {&settings.instances, &settings.next_instances})
        for (Instance& instance : *instances) {
            if (instance.paint != 0 || instance.field >= levels_.given()) continue;
            const uint32_t level =
                far_level_for(*levels_.all[instance.field], cameras, instance.world_from_performer, settings.samples);
            instance.field = levels_.index(instance.field, level);
        }
}

// Writes what the host writes for an image, creates what it needs on the device, and returns its settings with the
// levels at which instances are drawn.
FrameSettings FrameRenderer::begin(std::span<const stage::Camera> cameras, const FrameSettings& given) {
    make_performers(given.far_levels);
    FrameSettings settings = given;
    choose_far_levels(cameras, settings);
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
