// Blocks of leaves that a frame has of the frame before, and how they and its own leaves become one slice.
#pragma once

#include "stream/codec/quantised_slice.h"
#include "stream/codec/symbols.h"

namespace neuvv::stream {

constexpr uint32_t kBlockBits = 6;  // of a cell's code: blocks of 4³ finest cells are repeated

// The blocks of leaves: the index of the first leaf of each, and the end.
std::vector<size_t> blocks_of(const std::vector<Leaf>& leaves);

// The indices of the leaves of some blocks; `blocks` says of each whether it is one.
std::vector<uint32_t> leaves_in(const std::vector<Leaf>& leaves, const std::vector<bool>& blocks);

// Codes which blocks of the frame before are repeated; a writer's `repeats` say it. `Coder` is a SymbolWriter or a
// SymbolReader.
template <typename Coder>
std::vector<bool> code_repeats(Coder& coder, const std::vector<Leaf>& before, const std::vector<bool>* repeats) {
    std::vector<bool> coded(blocks_of(before).size() - 1);
    uint32_t last = 0;
    for (size_t i = 0; i < coded.size(); ++i) {
        last = coder.take(kRepeatTables + last, repeats && (*repeats)[i] ? 1 : 0);
        coded[i] = last != 0;
    }
    return coded;
}

// The leaves of a frame in order of their cells, and where they come from: runs of leaves of the frame before or of the
// frame's own.
struct MergedLeaves {
    struct Run {
        bool is_repeated = false;
        uint32_t first = 0, count = 0;  // indices in the frame before, or among its own leaves
    };
    std::vector<Leaf> leaves;
    std::vector<Run> runs;
    bool repeats_any = false;
};
// Throws std::runtime_error where leaves overlap.
MergedLeaves merge_leaves(const std::vector<Leaf>& before, const std::vector<uint32_t>& repeated, std::vector<Leaf> own,
                          uint32_t depth);

// The planes of the merged leaves. `before` is not read where nothing is repeated.
using Planes = std::vector<std::vector<int16_t>>;
Planes merge_planes(const MergedLeaves& merged, const Planes* before, Planes own);

}  // namespace neuvv::stream
