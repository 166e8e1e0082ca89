#include "render/shade.h"

#include "spirv/shade.comp.h"

namespace neuvv {

Buffer shaded_entries(const Device& device, uint32_t capacity) {
    return Buffer(device, "shaded entries", uint64_t{4} * kEntryWords * capacity, MemoryKind::kDevice,
                  VK_FORMAT_R32G32_UINT);
}

Shader::Shader(const Device& device, const Field& field, const SliceTree& tree, const Buffer& shaded)
    : field_(field),
      tree_(tree),
      pass_(device, "shade", shade_comp, {field.hh_degree}),
      set_(pass_, {{kShadeEntries, &tree.entries},
                   {kShadeLeaves, &tree.entry_leaf},
                   {kShadePlaces, &field.leaf_places},
                   {kShadeCount, &tree.count},
                   {kShadeOut, &shaded}}) {}

void record_shade(Commands& commands, const Shader& shader, glm::vec3 eye) {
    const PassScope scope(commands, "shade");
    const Field& field = shader.field_;
    dispatch_indirect(commands, shader.pass_, shader.set_, shader.tree_.count, 0,
                      ShadePush{glm::vec4(eye, 0), glm::vec4(field.box_min, 0), glm::vec4(field.box_size, 0),
                                shader.tree_.capacity});
    compute_barrier(commands);
}

}  // namespace neuvv
