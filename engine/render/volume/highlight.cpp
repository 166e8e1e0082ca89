#include "render/volume/highlight.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "spirv/bind_bones.comp.h"
#include "spirv/highlight.comp.h"

namespace neuvv::render {

BoneBinder::BoneBinder(const gpu::Device& device, const Field& given_field, const SliceTrees& given_trees)
    : field(given_field),
      trees(given_trees),
      bone_words(gpu::groups_of(trees.capacity, 4)),
      bones(device, "bones", sizeof(ShaderBones), gpu::MemoryKind::kDevice),
      entry_bones(device, "bones of entries", uint64_t{4} * bone_words * trees.slices, gpu::MemoryKind::kDevice,
                  VK_FORMAT_R32_UINT),
      pass(device, "bind bones", device.buffers().fitting(bind_bones_comp, bind_bones_comp_storage)),
      set(pass, {{kBindBones, &bones},
                 {kBindLeaves, &trees.entry_leaf},
                 {kBindPositions, &field.leaf_positions},
                 {kBindCount, &trees.counts},
                 {kBindOut, &entry_bones}}),
      bound(trees.slices) {}

void record_bind_bones(gpu::Commands& commands, BoneBinder& binder, uint32_t slice, uint64_t build,
                       std::span<const Bone> bones) {
    assert(bones.size() <= kMaxBones);
    BoneBinder::Bound wanted{build, {bones.begin(), bones.end()}};
    if (binder.bound[slice] == wanted) return;
    const gpu::PassScope scope(commands, "bind bones");
    ShaderBones shader_bones{};
    for (size_t i = 0; i < bones.size(); ++i)
        shader_bones.bones[i] = {glm::vec4(bones[i].from, bones[i].radius), glm::vec4(bones[i].to, 0)};
    gpu::update(commands, binder.bones, shader_bones);
    gpu::compute_barrier(commands);
    const Field& field = binder.field;
    gpu::dispatch_indirect(
        commands, binder.pass, binder.set, binder.trees.counts, slice * sizeof(LiveCount),
        BindBonesPush{glm::vec4(field.box_min, 0), glm::vec4(field.box_size, 0), slice, binder.trees.capacity,
                      binder.bone_words, static_cast<uint32_t>(bones.size())});
    gpu::compute_barrier(commands);
    binder.bound[slice] = std::move(wanted);
}

Highlighter::Highlighter(const gpu::Device& device, const BoneBinder& given_binder, const gpu::Buffer& shaded)
    : binder(given_binder),
      pass(device, "highlight", device.buffers().fitting(highlight_comp, highlight_comp_storage)),
      set(pass,
          {{kHighlightBones, &binder.entry_bones}, {kHighlightShaded, &shaded}, {kBindCount, &binder.trees.counts}}) {}

void record_highlight(gpu::Commands& commands, const Highlighter& highlighter, uint32_t slice, uint32_t view,
                      std::span<const float> tints) {
    assert(tints.size() <= kMaxBones);
    const gpu::PassScope scope(commands, "highlight");
    const SliceTrees& trees = highlighter.binder.trees;
    HighlightPush push{{}, slice, trees.capacity, highlighter.binder.bone_words, view};
    for (size_t i = 0; i < tints.size(); ++i) {
        const auto byte = static_cast<uint32_t>(std::lround(255 * std::clamp(tints[i], 0.0f, 1.0f)));
        push.tints[i / 4] |= byte << 8 * (i % 4);
    }
    gpu::dispatch_indirect(commands, highlighter.pass, highlighter.set, trees.counts, slice * sizeof(LiveCount), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
