#include "render/volume/pick.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <utility>

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

SlicePicker::SlicePicker(const gpu::Device& device, const Field& field, const SliceTrees& trees, uint32_t rays_at_once,
                         PickColours colours)
    : field_(field),
      trees_(trees),
      rays_at_once_(rays_at_once),
      rays_(device, "pick rays", sizeof(PickRay) * rays_at_once, gpu::MemoryKind::kUpload,
            VK_FORMAT_R32G32B32A32_SFLOAT),
      picks_(device, "picks", sizeof(Pick) * rays_at_once, gpu::MemoryKind::kReadback, VK_FORMAT_R32G32B32A32_UINT),
      pass_(device, "pick", device.buffers().fitting(pick_comp, pick_comp_storage),
            {field.hh_degree, field.node_levels, field.top_levels, uint32_t{colours == PickColours::kYes},
             uint32_t{field.has_srgb_colours}}),
      set_(pass_, {{kPickLinks, &field.links},
                   {kPickNodes, &trees.nodes},
                   {kPickEntries, &trees.entries},
                   {kPickLeaves, &trees.entry_leaf},
                   {kPickRays, &rays_},
                   {kPickOut, &picks_}}),
      commands_(device, "pick", 1) {}

void SlicePicker::begin(uint32_t slice, std::span<const PickRay> rays, float alpha) {
    assert(slice < trees_.slices && alpha > 0 && alpha < 1);
    assert(!is_picking() && !rays.empty() && rays.size() <= rays_at_once_);
    std::copy(rays.begin(), rays.end(), rays_.as<PickRay>());
    const auto count = static_cast<uint32_t>(rays.size());
    const PickPush push{glm::vec4(field_.box_min, 1 - alpha),
                        glm::vec4(field_.box_size, 0),
                        field_.top_box,
                        trees_.node_base(slice),
                        trees_.entry_base(slice),
                        0,
                        count};
    commands_.begin();
    {
        const gpu::PassScope scope(commands_, "pick");
        gpu::compute_barrier(commands_);  // images that are under way may build the slice
        gpu::dispatch(commands_, pass_, set_, count, push);
        gpu::compute_barrier(commands_);  // and later ones replace it
        gpu::host_barrier(commands_);
    }
    commands_.submit();
    picking_ = count;
}

std::vector<Picked> SlicePicker::take() {
    commands_.wait();
    const std::span from(picks_.as<Pick>(), std::exchange(picking_, 0));
    std::vector<Picked> picked;
    for (const Pick& one : from)
        picked.push_back({one.leaf, std::bit_cast<float>(one.metres),
                          glm::vec3(glm::unpackHalf2x16(one.red_green), glm::unpackHalf2x16(one.blue).x)});
    return picked;
}

std::vector<Picked> SlicePicker::pick(uint32_t slice, std::span<const PickRay> rays, float alpha) {
    std::vector<Picked> picked;
    for (size_t first = 0; first < rays.size(); first += rays_at_once_) {
        begin(slice, rays.subspan(first, std::min<size_t>(rays_at_once_, rays.size() - first)), alpha);
        const std::vector<Picked> batch = take();
        picked.insert(picked.end(), batch.begin(), batch.end());
    }
    return picked;
}

Picker::Picker(const gpu::Device& device, const Field& field, PickColours colours)
    : device_(device),
      field_(field),
      live_(device, field, field.leaf_count),
      trees_(device, field, max_entries(field), 1),
      slicer_(device, field, live_, trees_),
      painter_(device, field, live_, trees_),
      picker_(device, field, trees_, kRaysAtOnce, colours) {}

void Picker::show(float frame, std::span<const PaintUse> uses) {
    const Paint paint(device_, field_.leaf_count, uses);
    const SlicePaint bound(painter_, paint);
    gpu::run_once(device_, "slice to pick on",
                  [&](gpu::Commands& commands) { record_slice_tree(commands, slicer_, 0, frame, &bound); });
}

}  // namespace neuvv::render
