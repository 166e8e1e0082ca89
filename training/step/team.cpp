#include "training/step/team.h"

#include "base/error.h"

namespace neuvv::training {

namespace {

// What adopt_first_tree sends before leaf positions, weights, A and B.
struct TreeHead {
    uint32_t frames, bases, hh_degree, node_levels, leaf_count;
    glm::vec3 box_min, box_size;
};

template <typename T>
void append(Bytes& bytes, const T* values, size_t count) {
    const auto* first = reinterpret_cast<const uint8_t*>(values);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

template <typename T>
void take(const uint8_t*& from, T* values, size_t count) {
    std::memcpy(values, from, count * sizeof(T));
    from += count * sizeof(T);
}

Bytes bytes_of(const voctree::VOctree& tree) {
    const TreeHead head{tree.frames,     tree.bases,   tree.hh_degree, tree.node_levels,
                        tree.leaf_count, tree.box_min, tree.box_size};
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    Bytes bytes;
    append(bytes, &head, 1);
    append(bytes, positions.data(), positions.size());
    append(bytes, tree.weights.data(), tree.weights.size());
    append(bytes, tree.sigma_basis.data(), tree.sigma_basis.size());
    append(bytes, tree.gamma_basis.data(), tree.gamma_basis.size());
    return bytes;
}

void read_tree(const Bytes& bytes, voctree::VOctree& tree) {
    TreeHead head{};
    if (bytes.size() < sizeof(head)) throw_out_of_step();
    const uint8_t* from = bytes.data();
    take(from, &head, 1);
    const uint64_t numbers =
        uint64_t{head.leaf_count} * tree.weights_per_leaf() + uint64_t{2} * tree.frames * tree.bases;
    if (head.frames != tree.frames || head.bases != tree.bases || head.hh_degree != tree.hh_degree ||
        bytes.size() != sizeof(head) + head.leaf_count * sizeof(voctree::LeafPosition) + 4 * numbers)
        throw_out_of_step();
    tree.node_levels = head.node_levels;
    tree.box_min = head.box_min;
    tree.box_size = head.box_size;
    std::vector<voctree::LeafPosition> positions(head.leaf_count);
    take(from, positions.data(), positions.size());
    voctree::build_topology(tree, positions);
    take(from, tree.weights.data(), tree.weights.size());
    take(from, tree.sigma_basis.data(), tree.sigma_basis.size());
    take(from, tree.gamma_basis.data(), tree.gamma_basis.size());
}

}  // namespace

void throw_out_of_step() {
    throw RuntimeFailure("the processes that train together do not run the same program with the same options");
}

void adopt_first_tree(const Team& team, voctree::VOctree& tree) {
    if (team.is_alone()) return;
    const Bytes own = team.is_first() ? bytes_of(tree) : Bytes();
    const std::vector<Bytes> all = team.gather(own);
    if (!team.is_first()) read_tree(all[0], tree);
}

}  // namespace neuvv::training
