#include "training/step/slice_adjoint.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "gpu/host_copies.h"
#include "spirv/rows_adjoint.comp.h"
#include "spirv/slice_adjoint.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

namespace {

AdamPush adam_push(const AdamSettings& adam) {
    const auto bias = [&](float beta) {
        return static_cast<float>(1 - std::pow(static_cast<double>(beta), adam.step));
    };
    return {adam.beta1, adam.beta2, adam.epsilon, bias(adam.beta1), bias(adam.beta2), adam.emit_only ? 1u : 0u};
}

size_t frame_words(const voctree::VOctree& tree) {
    return (tree.frames + 31) / 32;
}

gpu::BindingSet leaf_bindings(const gpu::ComputePass& pass, const render::Field& field, const render::Slice& slice,
                              const SliceGradients& gradients, const Moments& moments, const LeafTally& tally) {
    return gpu::BindingSet(pass, {{kAdjointWeights, &field.whole_weights()},
                                  {kAdjointFirstMoments, &moments.first},
                                  {kAdjointSecondMoments, &moments.second},
                                  {kAdjointRows, &slice.rows},
                                  {kAdjointLeaves, &slice.slot_leaf},
                                  {kAdjointTouched, &gradients.touched},
                                  {kAdjointCount, &gradients.touched_count},
                                  {kAdjointGradients, &gradients.gradients},
                                  {kAdjointMaxWeight, &gradients.max_weight},
                                  {kAdjointLeafUse, &tally.use},
                                  {kAdjointLeafFrames, &tally.frames},
                                  {kAdjointPositions, &field.leaf_positions},
                                  {kAdjointHead, &slice.head},
                                  {kAdjointSh, &slice.sh},
                                  {kAdjointPartials, &gradients.partials}});
}

}  // namespace

Moments::Moments(const gpu::Device& device, const render::Field& field)
    : first(device, "first moments", field.whole_weights().bytes, gpu::MemoryKind::kDevice,
            VK_FORMAT_R32G32B32A32_SFLOAT),
      second(device, "second moments", field.whole_weights().bytes, gpu::MemoryKind::kDevice,
             VK_FORMAT_R32G32B32A32_SFLOAT),
      rows_first(device, "row first moments", uint64_t{8} * field.frames * field.bases, gpu::MemoryKind::kDevice,
                 VK_FORMAT_R32_SFLOAT),
      rows_second(device, "row second moments", uint64_t{8} * field.frames * field.bases, gpu::MemoryKind::kDevice,
                  VK_FORMAT_R32_SFLOAT) {
    gpu::run_once(device, "clear moments", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* buffer : {&first, &second, &rows_first, &rows_second}) gpu::fill(commands, *buffer, 0);
        gpu::compute_barrier(commands);
    });
}

LeafTally::LeafTally(const gpu::Device& device, const voctree::VOctree& tree)
    : use(device, "leaf use", uint64_t{8} * tree.leaf_count, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_SFLOAT),
      frames(device, "leaf frames", uint64_t{4} * frame_words(tree) * tree.leaf_count, gpu::MemoryKind::kDevice,
             VK_FORMAT_R32_UINT) {
    gpu::run_once(device, "clear leaf use", [&](gpu::Commands& commands) {
        gpu::fill(commands, use, 0);
        gpu::fill(commands, frames, 0);
        gpu::compute_barrier(commands);
    });
}

LeafUse read_use(const gpu::Device& device, const LeafTally& tally, const voctree::VOctree& tree) {
    std::vector<glm::vec2> pairs(tree.leaf_count);
    LeafUse use;
    use.frames.resize(frame_words(tree) * tree.leaf_count);
    gpu::download(device, tally.use, pairs.data(), pairs.size() * sizeof(glm::vec2));
    gpu::download(device, tally.frames, use.frames.data(), use.frames.size() * sizeof(uint32_t));
    for (const glm::vec2& pair : pairs) {
        use.max_weight.push_back(pair.x);
        use.opacity_sensitivity.push_back(pair.y);
    }
    return use;
}

void write_use(const gpu::Device& device, const LeafTally& tally, const LeafUse& use) {
    assert(use.max_weight.size() == use.opacity_sensitivity.size() && "use of one tree");
    std::vector<glm::vec2> pairs;
    for (size_t i = 0; i < use.max_weight.size(); ++i) pairs.push_back({use.max_weight[i], use.opacity_sensitivity[i]});
    gpu::upload(device, tally.use, pairs.data(), pairs.size() * sizeof(glm::vec2));
    gpu::upload(device, tally.frames, use.frames.data(), use.frames.size() * sizeof(uint32_t));
}

SliceAdjoint::SliceAdjoint(const gpu::Device& device, const render::Field& given_field, const render::Slice& slice,
                           const SliceGradients& given_gradients, const Moments& moments, const LeafTally& tally)
    : field(given_field),
      gradients(given_gradients),
      leaves(device, "slice adjoint", array_buffers(device).fitting(slice_adjoint_comp, slice_adjoint_comp_storage),
             {field.hh_degree, field.basis_planes(), 0, field.busy_planes}),
      leaves_and_rows(device, "slice adjoint with rows",
                      array_buffers(device).fitting(slice_adjoint_comp, slice_adjoint_comp_storage),
                      {field.hh_degree, field.basis_planes(), 1, field.busy_planes}),
      rows(device, "rows adjoint", array_buffers(device).fitting(rows_adjoint_comp, rows_adjoint_comp_storage)),
      leaves_set(leaf_bindings(leaves, field, slice, gradients, moments, tally)),
      leaves_and_rows_set(leaf_bindings(leaves_and_rows, field, slice, gradients, moments, tally)),
      rows_set(rows, {{kRowsAdjointPartials, &gradients.partials},
                      {kRowsAdjointCount, &gradients.touched_count},
                      {kRowsAdjointSigma, &field.sigma_basis},
                      {kRowsAdjointGamma, &field.gamma_basis},
                      {kRowsAdjointFirstMoments, &moments.rows_first},
                      {kRowsAdjointSecondMoments, &moments.rows_second}}) {}

void record_slice_adjoint(gpu::Commands& commands, const SliceAdjoint& adjoint, float frame, const LearningRates& rates,
                          const AdamSettings& adam, bool learn_rows) {
    const gpu::PassScope scope(commands, "slice adjoint");
    const render::Field& field = adjoint.field;
    const float last = static_cast<float>(field.frames - 1);
    const SliceAdjointPush push{adam_push(adam),
                                field.leaf_count,
                                static_cast<uint32_t>(std::clamp(std::floor(frame), 0.0f, last)),
                                static_cast<uint32_t>(std::clamp(std::ceil(frame), 0.0f, last)),
                                adam.min_used_weight,
                                rates.sigma,
                                rates.gamma,
                                rates.colour,
                                rates.detail,
                                field.box_size.x,
                                adam.least_depth};
    gpu::dispatch_indirect(commands, learn_rows ? adjoint.leaves_and_rows : adjoint.leaves,
                           learn_rows ? adjoint.leaves_and_rows_set : adjoint.leaves_set,
                           adjoint.gradients.touched_count, 0, push);
    gpu::compute_barrier(commands);
    if (!learn_rows) return;
    gpu::dispatch_groups(
        commands, adjoint.rows, adjoint.rows_set, 1,
        RowsAdjointPush{adam_push(adam), frame, field.frames, field.bases, rates.sigma_rows, rates.gamma_rows});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
