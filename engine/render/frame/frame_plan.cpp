#include "render/frame/frame_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "render/volume/draw_order.h"

namespace neuvv::render {

namespace {

// The instance as an inspection draws it: not merged with others, without set and lights.
DrawnInstance inspected(DrawnInstance instance) {
    instance.shading = Shading::kNone;
    instance.output = RayOutput::kInspect;
    instance.rays.set_size = {};
    instance.rays.lighting = 0;
    instance.highlight.reset();
    return instance;
}

// Groups of instances, near to far, so that rays end at the first solid surface.
std::vector<std::vector<uint32_t>> instance_order(std::span<const stage::Camera> cameras, const FrameSettings& settings,
                                                  const FieldLevels& levels) {
    std::vector<glm::dvec3> eyes;
    for (const stage::Camera& camera : cameras) eyes.emplace_back(camera.world_from_camera[3]);
    std::vector<TransformedBox> boxes;
    for (const Instance& instance : settings.instances) {
        const Field& field = *levels.all[instance.field];
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

// Completes how an instance is drawn.
void apply_settings(DrawnInstance& drawn, const Instance& instance, const FrameSettings& settings,
                    const ViewLayout& layout, bool has_set) {
    if (settings.mode == TraceMode::kTree) drawn.shading = Shading::kPerRay;
    if (settings.mode == TraceMode::kShaded) drawn.shading = Shading::kPerLeaf;
    drawn.highlight = instance.highlight;
    drawn.performer = instance.performer;
    if (instance.highlight) drawn.shading = Shading::kPerLeaf;
    drawn.output = settings.blend == Blend::kPaper ? RayOutput::kLayerByDepth : RayOutput::kLayer;
    drawn.rays.stop = settings.stop;
    if (has_set) drawn.rays.set_size = layout.samples * glm::uvec2(layout.width, layout.height);
    if (has_set && settings.lit) drawn.rays.lighting = kLit | (instance.receives_shadow ? kShadowed : 0u);
}

}  // namespace

bool is_upscaled(const FrameSettings& settings) {
    return settings.scale != 1 || !settings.foveae.empty();
}

void expect_drawable(std::span<const stage::Camera> cameras, const FrameSettings& settings, uint32_t fields) {
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
        if (settings.instances[i].field >= fields)
            throw RuntimeFailure(fmt::format("instance {}: there is no field {}", i, settings.instances[i].field));
    }
}

void plan_views(FramePlan& plan, std::span<const stage::Camera> cameras, const FrameSettings& settings) {
    plan.layout = {settings.width, settings.height, settings.samples, static_cast<uint32_t>(cameras.size())};
    plan.grids.clear();
    plan.set_cameras.clear();
    for (const stage::Camera& camera : cameras) plan.set_cameras.push_back(stage::enlarged(camera, settings.samples));
    if (!is_upscaled(settings)) return;
    assert(settings.samples == 1);
    for (uint32_t view = 0; view < plan.layout.views; ++view) {
        const Fovea fovea = settings.foveae.empty() ? Fovea{} : settings.foveae[view];
        plan.grids.push_back(ray_grid(settings.width, settings.height, settings.scale, fovea));
        plan.layout.rays = glm::max(plan.layout.rays, plan.grids.back().rays);
    }
}

void plan_instances(FramePlan& plan, const TargetViews& views, const FrameSettings& settings, const FieldLevels& levels,
                    bool has_set) {
    plan.drawn.clear();
    uint32_t placed = 0;
    for (const std::vector<uint32_t>& group : instance_order(views.cameras, settings, levels)) {
        std::vector<DrawnInstance> drawn;
        for (const uint32_t i : group) {
            const Instance& instance = settings.instances[i];
            auto one = write_instance_cameras(views, *levels.all[instance.field], instance, placed);
            if (!one) continue;
            apply_settings(*one, instance, settings, plan.layout, has_set);
            ++placed;
            if (is_inspection(settings.resolve.show))
                plan.drawn.push_back({inspected(*one)});
            else
                drawn.push_back(*one);
        }
        if (drawn.size() > 1)
            for (DrawnInstance& instance : drawn) instance.output = RayOutput::kIntervals;
        if (!drawn.empty()) plan.drawn.push_back(std::move(drawn));
    }
}

SliceRequests slice_requests(const FramePlan& plan, std::span<const DrawnInstance> shadows,
                             std::span<const Instance> next, const FieldLevels& levels) {
    const size_t fields = levels.all.size();
    SliceRequests requests{std::vector<std::vector<SliceKey>>(fields), std::vector<std::vector<SliceKey>>(fields)};
    for (const bool highlighted : {true, false})
        for (const auto& group : plan.drawn)
            for (const DrawnInstance& instance : group)
                if ((instance.highlight != nullptr) == highlighted)
                    requests.now[instance.field].push_back(instance.slice());
    for (const DrawnInstance& instance : shadows) requests.now[instance.field].push_back(instance.slice());
    for (const Instance& one : next)
        if (one.field < fields) requests.next[one.field].push_back({one.frame, one.paint});
    return requests;
}

}  // namespace neuvv::render
