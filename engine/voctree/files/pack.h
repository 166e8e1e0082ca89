// Converts the numbers of a tree into bytes that compress well, the content of a .nvv's larger chunks, and back. The
// byte layouts are specified in README.md beside this file.
#pragma once

#include <cstdint>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

std::vector<uint8_t> pack_children(const std::vector<uint32_t>& children);
std::vector<uint32_t> unpack_children(const std::vector<uint8_t>& bytes);

// Which of a leaf's bases have weights: bit c % 8 of byte [c / 8][leaf] is set where w^σ_c or w^γ_c is not 0.
std::vector<uint8_t> pack_presence(const VOctree& tree);
// Whether no bit is set for a basis that the tree does not have.
bool presence_fits(const VOctree& tree, const std::vector<uint8_t>& presence);

// The columns of the weight matrix (leaves × weights_per_leaf) that one chunk stores.
struct WeightRange {
    uint32_t first, count;
    bool sparse;  // columns of bases: only numbers of bases that `presence` marks are stored; all others are 0
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

// Rounds every weight to the nearest half; besides that, only the sign of zeros is lost.
std::vector<uint8_t> pack_weights(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence);
uint64_t packed_weight_bytes(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence);
// Unpacks into `tree.weights`, which must already have its size, and be 0 where `range` is sparse. `bytes` must have
// packed_weight_bytes() elements. Returns false where the coding of a column is unknown.
bool unpack_weights(VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence,
                    const std::vector<uint8_t>& bytes);

}  // namespace neuvv::voctree
