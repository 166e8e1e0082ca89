#include "render/pick.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "spirv/pick.comp.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kRaysAtOnce = 1u << 18;

}  // namespace

PickRay pick_ray(const stage::Camera& camera, glm::dvec2 pixel) {
    const glm::dvec3 line((pixel.x - camera.cx) / camera.fx, -(pixel.y - camera.cy) / camera.fy, -1);
    const glm::dvec3 direction = glm::normalize(glm::dmat3(camera.world_from_camera) * line);
    return {glm::vec4(glm::vec3(camera.world_from_camera[3]), 0), glm::vec4(glm::vec3(direction), 0)};
}

Picker::Picker(const gpu::Device& device, const Field& field)
    : device_(device),
      field_(field),
      live_(device, field, field.leaf_count),
      trees_(device, field, max_entries(field), 1),
      slicer_(device, field, live_, trees_),
      painter_(device, field, live_, trees_),
      rays_(device, "pick rays", sizeof(PickRay) * kRaysAtOnce, gpu::MemoryKind::kUpload,
            VK_FORMAT_R32G32B32A32_SFLOAT),
      picks_(device, "picks", sizeof(Pick) * kRaysAtOnce, gpu::MemoryKind::kReadback, VK_FORMAT_R32G32_UINT),
      pass_(device, "pick", pick_comp, {field.hh_degree, field.node_levels, field.top_levels}),
      set_(pass_, {{kPickTop, &field.top},
                   {kPickNodes, &trees_.nodes},
                   {kPickEntries, &trees_.entries},
                   {kPickLeaves, &trees_.entry_leaf},
                   {kPickRays, &rays_},
                   {kPickOut, &picks_}}) {}

void Picker::show(float frame, std::span<const PaintUse> uses) {
    const Paint paint(device_, field_.leaf_count, uses);
    const SlicePaint bound(painter_, paint);
    gpu::run_once(device_, "slice to pick on",
                  [&](gpu::Commands& commands) { record_slice_tree(commands, slicer_, 0, frame, &bound); });
}

std::vector<Picked> Picker::pick_batch(std::span<const PickRay> rays, float alpha) {
    std::copy(rays.begin(), rays.end(), rays_.as<PickRay>());
    const auto count = static_cast<uint32_t>(rays.size());
    gpu::run_once(device_, "pick", [&](gpu::Commands& commands) {
        const PickPush push{
            glm::vec4(field_.box_min, 1 - alpha), glm::vec4(field_.box_size, 0), field_.top_box, 0, 0, 0, count};
        gpu::dispatch(commands, pass_, set_, count, push);
        gpu::host_barrier(commands);
    });
    std::vector<Picked> picked(rays.size());
    const Pick* from = picks_.as<Pick>();
    for (size_t i = 0; i < picked.size(); i++) picked[i] = {from[i].leaf, std::bit_cast<float>(from[i].metres)};
    return picked;
}

std::vector<Picked> Picker::pick(std::span<const PickRay> rays, float alpha) {
    assert(alpha > 0 && alpha < 1);
    std::vector<Picked> picked;
    picked.reserve(rays.size());
    for (size_t first = 0; first < rays.size(); first += kRaysAtOnce) {
        const std::vector<Picked> batch =
            pick_batch(rays.subspan(first, std::min<size_t>(kRaysAtOnce, rays.size() - first)), alpha);
        picked.insert(picked.end(), batch.begin(), batch.end());
    }
    return picked;
}

}  // namespace neuvv::render
