#include "render/volume/slices/dequantise.h"

#include <algorithm>

#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "shared/dequantise.h"
#include "slice/curves.h"

#include "spirv/dequantise.comp.h"

namespace neuvv::render {

namespace {

static_assert(kMeanCount == slice::kColourHalves && kOpacityCount == slice::kOpacities &&
              kTableSigma == kMeanCount * (kMaxHhDegree + 2) && stream::kOpacityPlane == 0 &&
              stream::kFirstColourPlane == 1);

std::vector<float> tables_of(uint32_t depth, glm::vec3 box_size) {
    const slice::ColourCurves& curves = slice::colour_curves();
    std::vector<float> tables(curves.constant.begin(), curves.constant.end());
    for (const auto& per_unit : curves.per_unit) tables.insert(tables.end(), per_unit.begin(), per_unit.end());
    for (const float sigma : slice::sigmas_of(depth, box_size)) tables.push_back(std::min(sigma, kMaxEntryNumber));
    return tables;
}

}  // namespace

Dequantiser usual_dequantiser(const gpu::Device& device) {
    return device.summary().kind == "discrete" ? Dequantiser::kDevice : Dequantiser::kHost;
}

void dequantise(const gpu::Device& device, const stream::QuantisedSlice& slice, const SliceLayout& layout,
                glm::vec3 box_size, const gpu::Buffer& leaf_positions, const SliceBuffers& to) {
    const auto leaves = static_cast<uint32_t>(slice.leaves.size()),
               nodes = static_cast<uint32_t>(layout.node_entries.size()), plane_words = (leaves + 1) / 2;
    if (leaves + nodes == 0) return;
    expect_dispatch(device, leaves + nodes, Remedy::kFewerLeaves);
    gpu::Uploads uploads(device);
    const gpu::Buffer planes =
        uploads.add_written("planes of a slice", sizeof(uint32_t) * plane_words * slice.planes.size(),
                            VK_FORMAT_R32_UINT, [&](void* words) {
                                for (size_t i = 0; i < slice.planes.size(); ++i)
                                    std::copy(slice.planes[i].begin(), slice.planes[i].end(),
                                              static_cast<int16_t*>(words) + 2 * i * plane_words);
                            });
    const gpu::Buffer entry_of_leaf =
        uploads.add_written("entries of leaves", sizeof(uint32_t) * leaves, VK_FORMAT_R32_UINT, [&](void* words) {
            for (uint32_t i = 0; i < leaves; ++i) {
                const uint32_t entry = layout.entry_of_leaf[i];
                static_cast<uint32_t*>(words)[i] =
                    entry == kNoLeaf ? kNoLeaf : layout.entry_of(slice.leaves[i].depth, entry);
            }
        });
    static_assert(sizeof(SliceLayout::NodeEntry) == sizeof(glm::uvec2));
    const gpu::Buffer node_entries = uploads.add_copied("entries of nodes", layout.node_entries, VK_FORMAT_R32G32_UINT),
                      tables =
                          uploads.add_copied("dequantiser", tables_of(slice.depth, box_size), VK_FORMAT_R32_SFLOAT);
    uploads.finish();
    const gpu::ComputePass pass(device, "dequantise",
                                device.buffers().fitting(dequantise_comp, dequantise_comp_storage), {slice.degree});
    const gpu::BindingSet set(pass, {{kDequantisePlanes, &planes},
                                     {kDequantiseEntries, &entry_of_leaf},
                                     {kDequantisePositions, &leaf_positions},
                                     {kDequantiseNodes, &node_entries},
                                     {kDequantiseTables, &tables},
                                     {kDequantiseOut, &to.entries},
                                     {kDequantiseLeaves, &to.entry_leaf}});
    gpu::run_once(device, "dequantise", [&](gpu::Commands& commands) {
        const gpu::PassScope scope(commands, "dequantise");
        gpu::dispatch(commands, pass, set, leaves + nodes,
                      DequantisePush{leaves, nodes, plane_words, layout.scale - 1});
        gpu::compute_barrier(commands);
    });
}

}  // namespace neuvv::render
