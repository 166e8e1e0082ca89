// The numbers of a tree as bytes that compress well: the content of a .nvv's larger chunks. Byte layouts: README.md
// beside this file.
#pragma once

#include <cstdint>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

std::vector<uint8_t> pack_children(const std::vector<uint32_t>& children);
std::vector<uint32_t> unpack_children(const std::vector<uint8_t>& bytes);

// Which of a leaf's bases have weights: bit c % 8 of byte [c / 8][leaf] says that w^σ_c or w^γ_c is not 0.
std::vector<uint8_t> pack_presence(const VOctree& tree);
// False where a bit stands for no basis.
bool presence_fits(const VOctree& tree, const std::vector<uint8_t>& presence);

// Columns of the weight matrix that one chunk holds.
struct WeightRange {
    uint32_t first, count;
    bool sparse;  // columns of bases: only the numbers that `presence` has are there; all others are 0
};
inline WeightRange sigma_range(const VOctree& tree) {
    return {0, tree.bases, true};
}
inline WeightRange gamma_range(const VOctree& tree) {
    return {tree.bases, tree.bases, true};
}
inline WeightRange colour_range(const VOctree& tree) {
    return {2 * tree.bases, 3 * hh_count(tree.hh_degree), false};
}

// Every weight as the half nearest to it, without further loss but that of a zero's sign.
std::vector<uint8_t> pack_weights(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence);
uint64_t packed_weight_bytes(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence);
// Into `tree.weights`, which has its size and is 0 where `range` is sparse. `bytes` are packed_weight_bytes() many.
// False where a column's coding is unknown.
bool unpack_weights(VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence,
                    const std::vector<uint8_t>& bytes);

}  // namespace neuvv::voctree
