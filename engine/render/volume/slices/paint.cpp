#include "render/volume/slices/paint.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "gpu/host_copies.h"
#include "render/volume/slices/slice_tree.h"
#include "voctree/files/half.h"

#include "spirv/paint_colour.comp.h"
#include "spirv/paint_density.comp.h"

namespace neuvv::render {

namespace {

// A paint in the layout that its shaders read.
struct PackedPaint {
    std::vector<glm::uvec2> leaves, layers;
    std::vector<glm::uvec4> edits;
    std::vector<uint32_t> sigmas;
};

// The bits of a frame, none of −0, as paint_edits.glsl compares them.
uint32_t frame_bits(float frame) {
    return std::bit_cast<uint32_t>(frame + 0.0f);
}

uint32_t halves(float low, float high) {
    return voctree::half_from_float(low) | uint32_t{voctree::half_from_float(high)} << 16;
}

// Sorts the edits by leaf, and those of a leaf by layer, the lowest first. Each layer has its edits sorted by leaf.
PackedPaint pack(std::span<const PaintUse> uses) {
    PackedPaint packed;
    std::vector<uint32_t> next;  // per leaf: the index for its next edit
    for (const PaintUse& use : uses) {
        next.resize(std::max<size_t>(next.size(), use.layer->field.leaf_count + size_t{1}));
        for (const voctree::LeafEdit& edit : use.layer->edits) ++next[edit.leaf + 1];
    }
    for (size_t leaf = 1; leaf < next.size(); ++leaf) {
        if (next[leaf] > 0) packed.leaves.emplace_back(static_cast<uint32_t>(leaf - 1), next[leaf - 1]);
        next[leaf] += next[leaf - 1];
    }
    const uint32_t count = next.empty() ? 0 : next.back();
    packed.leaves.emplace_back(0, count);
    packed.edits.resize(count);
    packed.sigmas.resize(count);
    for (uint32_t i = 0; i < uses.size(); ++i) {
        packed.layers.emplace_back(static_cast<uint32_t>(uses[i].blend), std::bit_cast<uint32_t>(uses[i].opacity));
        for (const voctree::LeafEdit& edit : uses[i].layer->edits) {
            const uint32_t at = next[edit.leaf]++;
            packed.edits[at] = {frame_bits(edit.first), frame_bits(edit.last), halves(edit.colour.r, edit.colour.g),
                                halves(edit.colour.b, edit.alpha)};
            packed.sigmas[at] = voctree::half_from_float(edit.sigma) | i << 16;
        }
    }
    return packed;
}

PaintPush paint_push(const Paint& paint, float frame) {
    PaintPush push{};
    push.frame = frame + 0.0f;
    push.leaves = paint.leaf_count;
    return push;
}

}  // namespace

Paint::Paint(const gpu::Device& device, uint32_t field_leaves, std::span<const PaintUse> uses) {
    if (uses.size() > kPaintLayerLimit)
        throw RuntimeFailure(fmt::format("{} layers of paint are more than {}", uses.size(), kPaintLayerLimit));
    for (const PaintUse& use : uses)
        if (use.layer->field.leaf_count != field_leaves)
            throw RuntimeFailure(fmt::format("paint for {} leaves does not fit a field of {}",
                                             use.layer->field.leaf_count, field_leaves));
    const PackedPaint packed = pack(uses);
    leaf_count = static_cast<uint32_t>(packed.leaves.size() - 1);
    leaves = gpu::uploaded(device, "painted leaves", packed.leaves, VK_FORMAT_R32G32_UINT);
    edits = gpu::uploaded(device, "paint edits", packed.edits, VK_FORMAT_R32G32B32A32_UINT);
    sigmas = gpu::uploaded(device, "paint densities", packed.sigmas, VK_FORMAT_R32_UINT);
    layers = gpu::uploaded(device, "paint layers", packed.layers, VK_FORMAT_R32G32_UINT);
}

uint32_t Paints::add(const std::shared_ptr<const Paint>& paint) {
    paints_.try_emplace(++last_, paint);
    return last_;
}

const Paint* Paints::find(uint32_t paint) const {
    const auto found = paints_.find(paint);
    return found == paints_.end() ? nullptr : found->second.get();
}

Painter::Painter(const gpu::Device& device, const Field& given_field, const LiveLeaves& given_live,
                 const SliceTrees& given_trees)
    : field(given_field),
      live(given_live),
      trees(given_trees),
      density(device, "paint density", device.buffers().fitting(paint_density_comp, paint_density_comp_storage)),
      colour(device, "paint colour", device.buffers().fitting(paint_colour_comp, paint_colour_comp_storage),
             {field.hh_degree, field.has_srgb_colours ? 1u : 0u}) {}

SlicePaint::SlicePaint(const Painter& passes, const Paint& layers)
    : painter(passes),
      paint(layers),
      density_set(passes.density, {{kPaintLeaves, &layers.leaves},
                                   {kPaintEdits, &layers.edits},
                                   {kPaintSigmas, &layers.sigmas},
                                   {kPaintLayers, &layers.layers},
                                   {kPaintHead, &passes.live.head},
                                   {kPaintSlots, &passes.live.slot_leaf},
                                   {kPaintLive, &passes.live.live},
                                   {kPaintCells, &passes.field.leaf_cells},
                                   {kPaintNodeLive, &passes.live.node_live}}),
      colour_set(passes.colour, {{kPaintLeaves, &layers.leaves},
                                 {kPaintEdits, &layers.edits},
                                 {kPaintSigmas, &layers.sigmas},
                                 {kPaintLayers, &layers.layers},
                                 {kPaintCells, &passes.field.leaf_cells},
                                 {kPaintNodes, &passes.trees.nodes},
                                 {kPaintEntries, &passes.trees.entries}}) {}

void record_paint_density(gpu::Commands& commands, const SlicePaint& paint, float frame) {
    if (paint.paint.leaf_count == 0) return;
    const gpu::PassScope scope(commands, "paint density");
    PaintPush push = paint_push(paint.paint, frame);
    push.capacity = paint.painter.live.capacity;
    gpu::dispatch(commands, paint.painter.density, paint.density_set, paint.paint.leaf_count, push);
    gpu::compute_barrier(commands);
}

void record_paint_colour(gpu::Commands& commands, const SlicePaint& paint, uint32_t slice, float frame) {
    if (paint.paint.leaf_count == 0) return;
    const gpu::PassScope scope(commands, "paint colour");
    PaintPush push = paint_push(paint.paint, frame);
    push.node_base = paint.painter.trees.node_base(slice);
    gpu::dispatch(commands, paint.painter.colour, paint.colour_set, paint.paint.leaf_count, push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
