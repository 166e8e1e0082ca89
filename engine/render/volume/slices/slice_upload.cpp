#include "render/volume/slices/slice_upload.h"

#include <utility>

#include "base/trace_file.h"
#include "gpu/host_copies.h"
#include "render/volume/slices/slice_entries.h"

namespace neuvv::render {

namespace {

// All but the entries and their leaves.
struct UploadedShape {
    Field field;
    SliceLayout layout;
    SliceBuffers built;
};

UploadedShape upload_shape(gpu::Uploads& uploads, const gpu::Device& device, const stream::QuantisedSlice& slice,
                           glm::vec3 box_min, glm::vec3 box_size) {
    UploadedShape shape;
    Field& field = shape.field;
    SliceLayout& layout = shape.layout;
    field.leaf_positions = uploads.add_written(
        "leaf positions", sizeof(glm::uvec2) * slice.leaves.size(), VK_FORMAT_R32G32_UINT, [&](void* to) {
            layout = slice_layout(slice, {static_cast<glm::uvec2*>(to), slice.leaves.size()});
        });
    expect_dispatch(device, layout.entries, Remedy::kFewerLeaves);
    field.box_min = box_min;
    field.leaf_count = static_cast<uint32_t>(slice.leaves.size());
    field.hh_degree = slice.degree;
    set_shape(field, layout, box_size);
    const std::vector<LiveCount> counts{{gpu::groups_of(layout.entries, kSliceGroup), 1, 1, layout.entries, 0}};
    field.links = uploads.add_copied("tree links", layout.top.cells, VK_FORMAT_R32_UINT);
    field.node_cells = uploads.add_copied("node cells", layout.inner_cells, VK_FORMAT_R32G32_UINT);
    field.node_positions = uploads.add_copied("node positions", layout.node_positions, VK_FORMAT_R32G32_UINT);
    shape.built.nodes = uploads.add_copied("slice nodes", layout.nodes, VK_FORMAT_R32G32B32A32_UINT);
    shape.built.counts = uploads.add_copied("counts of entries", counts, VK_FORMAT_UNDEFINED);
    return shape;
}

}  // namespace

Field upload_slice(const gpu::Device& device, const stream::QuantisedSlice& slice, glm::vec3 box_min,
                   glm::vec3 box_size, std::optional<Dequantiser> by) {
    const TraceSpan span("upload a slice");
    gpu::Uploads uploads(device);
    UploadedShape shape = upload_shape(uploads, device, slice, box_min, box_size);
    Field& field = shape.field;
    const SliceLayout& layout = shape.layout;
    SliceBuffers& built = shape.built;
    const uint64_t entry_bytes = sizeof(glm::uvec2) * sh_count(slice.degree) * layout.entries,
                   leaf_bytes = sizeof(uint32_t) * layout.entries;
    constexpr const char *kEntries = "slice entries", *kLeaves = "leaves of entries";
    if (by.value_or(usual_dequantiser(device)) == Dequantiser::kDevice) {
        built.entries = gpu::Buffer(device, kEntries, entry_bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT);
        built.entry_leaf = gpu::Buffer(device, kLeaves, leaf_bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT);
        uploads.finish();
        dequantise(device, slice, layout, box_size, field.leaf_positions, built);
    } else {
        built.entries = uploads.add_written(kEntries, entry_bytes, VK_FORMAT_R32G32_UINT, [&](void* to) {
            const TraceSpan entries("write the entries of a slice");
            write_entries(slice, layout, box_size, static_cast<glm::uvec2*>(to));
        });
        built.entry_leaf = uploads.add_written(kLeaves, leaf_bytes, VK_FORMAT_R32_UINT, [&](void* to) {
            write_entry_leaves(slice, layout, static_cast<uint32_t*>(to));
        });
        uploads.finish();
    }
    field.slice = std::make_shared<const SliceTrees>(std::move(built), field.node_count(), layout.entries);
    return std::move(shape.field);
}

}  // namespace neuvv::render
