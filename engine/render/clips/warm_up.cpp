#include "render/clips/warm_up.h"

#include "base/trace_file.h"
#include "render/frame/frame.h"

namespace neuvv::render {

namespace {

// From before the field's box, which fills the image.
stage::Camera camera_at(const Field& field, uint32_t side) {
    const glm::dvec3 size(field.box_size), middle = glm::dvec3(field.box_min) + 0.5 * size;
    stage::Camera camera;
    camera.width = camera.height = side;
    camera.fx = camera.fy = side;
    camera.cx = camera.cy = 0.5 * side;
    camera.world_from_camera = glm::dmat4(1);
    camera.world_from_camera[3] = glm::dvec4(middle + glm::dvec3(0, 0, 1.5 * glm::length(size)), 1);
    return camera;
}

}  // namespace

void warm_up(const gpu::Device& device, const Field& field) {
    constexpr uint32_t kSide = 16;
    const TraceSpan span("warm up");
    FrameCapacity capacity{kSide, kSide};
    capacity.slice_budget = 1;  // one slice
    FrameRenderer renderer(device, field, capacity);
    const stage::Camera camera = camera_at(field, kSide);
    FrameSettings settings;
    settings.width = settings.height = kSide;
    for (const bool far_levels : {false, true}) {
        if (far_levels && field.coarser.empty()) continue;
        settings.far_levels = far_levels;
        for (const TraceMode mode : {TraceMode::kTree, TraceMode::kShaded})
            for (const size_t instances : {1, 2}) {  // two in the same place are merged
                settings.mode = mode;
                settings.instances.resize(instances);
                renderer.draw(std::span(&camera, 1), settings);
            }
    }
    const PickRay ray{glm::vec4(camera.world_from_camera[3]), glm::vec4(0, 0, -1, 0)};
    if (renderer.begin_pick(settings.instances[0], std::span(&ray, 1), 0.5f)) renderer.take_picks();
}

}  // namespace neuvv::render
