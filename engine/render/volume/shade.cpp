#include "render/volume/shade.h"

#include "spirv/shade.comp.h"

namespace neuvv::render {

gpu::Buffer shaded_entries(const gpu::Device& device, uint32_t capacity, uint32_t views) {
    return gpu::Buffer(device, "shaded entries", uint64_t{4} * kEntryWords * capacity * views, gpu::MemoryKind::kDevice,
                       VK_FORMAT_R32G32_UINT);
}

Shader::Shader(const gpu::Device& device, const Field& given_field, const SliceTrees& given_trees,
               const gpu::Buffer& shaded)
    : field(given_field),
      trees(given_trees),
      pass(device, "shade", device.buffers().fitting(shade_comp, shade_comp_storage), {field.hh_degree}),
      set(pass, {{kShadeEntries, &trees.entries},
                 {kShadeLeaves, &trees.entry_leaf},
                 {kShadePositions, &field.leaf_positions},
                 {kShadeCount, &trees.counts},
                 {kShadeOut, &shaded}}) {}

void record_shade(gpu::Commands& commands, const Shader& shader, uint32_t slice, uint32_t view, glm::vec3 eye) {
    const gpu::PassScope scope(commands, "shade");
    const Field& field = shader.field;
    gpu::dispatch_indirect(commands, shader.pass, shader.set, shader.trees.counts, slice * sizeof(LiveCount),
                           ShadePush{glm::vec4(eye, 0), glm::vec4(field.box_min, 0), glm::vec4(field.box_size, 0),
                                     slice, shader.trees.capacity, view});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
