#include "web/slice_tree.h"

#include <memory>
#include <new>
#include <vector>

#include "base/threads/parallel.h"
#include "render/volume/slices/slice_entries.h"
#include "stream/codec/group_slice.h"

struct NeuvvSliceTree {
    neuvv::render::SliceLayout layout;
    std::vector<glm::uvec2> entries;
    NeuvvSliceTreeShape shape;
};

namespace neuvv {

namespace {

std::unique_ptr<NeuvvSliceTree> tree_of(const stream::QuantisedSlice& slice, glm::vec3 box_size) {
    auto tree = std::make_unique<NeuvvSliceTree>();
    std::vector<glm::uvec2> positions(slice.leaves.size());  // nobody here asks where leaves are
    tree->layout = render::slice_layout(slice, positions);
    const render::SliceLayout& layout = tree->layout;
    tree->entries.resize(size_t{layout.entries} * sh_count(slice.degree));
    render::write_entries(slice, layout, box_size, tree->entries.data());
    const TopBox top = render::top_box(layout.top.bounds);
    tree->shape = {static_cast<uint32_t>(layout.nodes.size()),
                   layout.entries,
                   static_cast<uint32_t>(layout.top.cells.size()),
                   layout.node_levels,
                   layout.top.levels,
                   top.first,
                   top.last,
                   layout.scale};
    return tree;
}

}  // namespace

// A worker is one thread.
void parallel_for(size_t count, size_t, const std::function<void(size_t begin, size_t end)>& run) {
    if (count > 0) run(0, count);
}

}  // namespace neuvv

NeuvvSliceTree* neuvv_slice_tree_new(const NeuvvGroupDecoder* group, float size_x, float size_y, float size_z) {
    const neuvv::stream::QuantisedSlice* slice = neuvv::stream::last_slice(group);
    if (!slice) return nullptr;
    try {
        return neuvv::tree_of(*slice, {size_x, size_y, size_z}).release();
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

void neuvv_slice_tree_free(NeuvvSliceTree* tree) {
    const std::unique_ptr<NeuvvSliceTree> owner(tree);
}

const NeuvvSliceTreeShape* neuvv_slice_tree_shape(const NeuvvSliceTree* tree) {
    return &tree->shape;
}
const uint32_t* neuvv_slice_tree_nodes(const NeuvvSliceTree* tree) {
    return &tree->layout.nodes.data()->x;
}
const uint32_t* neuvv_slice_tree_entries(const NeuvvSliceTree* tree) {
    return reinterpret_cast<const uint32_t*>(tree->entries.data());
}
const uint32_t* neuvv_slice_tree_links(const NeuvvSliceTree* tree) {
    return tree->layout.top.cells.data();
}
