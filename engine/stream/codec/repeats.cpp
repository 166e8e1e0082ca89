#include "stream/codec/repeats.h"

#include <stdexcept>

namespace neuvv::stream {

std::vector<size_t> blocks_of(const std::vector<Leaf>& leaves) {
    std::vector<size_t> first;
    for (size_t i = 0; i < leaves.size(); ++i)
        if (i == 0 || leaves[i].cell >> kBlockBits != leaves[i - 1].cell >> kBlockBits) first.push_back(i);
    first.push_back(leaves.size());
    return first;
}

std::vector<uint32_t> leaves_in(const std::vector<Leaf>& leaves, const std::vector<bool>& blocks) {
    std::vector<uint32_t> indices;
    const std::vector<size_t> first = blocks_of(leaves);
    for (size_t i = 0; i < blocks.size(); ++i)
        for (size_t leaf = first[i]; blocks[i] && leaf < first[i + 1]; ++leaf)
            indices.push_back(static_cast<uint32_t>(leaf));
    return indices;
}

MergedLeaves merge_leaves(const std::vector<Leaf>& before, const std::vector<uint32_t>& repeated, std::vector<Leaf> own,
                          uint32_t depth) {
    MergedLeaves merged;
    merged.repeats_any = !repeated.empty();
    if (!merged.repeats_any) {
        merged.runs = {{false, 0, static_cast<uint32_t>(own.size())}};
        merged.leaves = std::move(own);
        return merged;
    }
    merged.leaves.reserve(repeated.size() + own.size());
    const auto append = [&](const Leaf& leaf, bool is_repeated, uint32_t index) {
        if (!merged.leaves.empty()) {
            const Leaf& last = merged.leaves.back();
            if (leaf.cell - last.cell < uint64_t{1} << 3 * (depth - last.depth))
                throw std::runtime_error("repeats leaves where it has others");
        }
        merged.leaves.push_back(leaf);
        if (!merged.runs.empty()) {
            MergedLeaves::Run& run = merged.runs.back();
            if (run.is_repeated == is_repeated && run.first + run.count == index) {
                ++run.count;
                return;
            }
        }
        merged.runs.push_back({is_repeated, index, 1});
    };
    for (size_t i = 0, j = 0; i < repeated.size() || j < own.size();) {
        const bool takes_own = i == repeated.size() || (j < own.size() && own[j].cell <= before[repeated[i]].cell);
        if (takes_own) {
            append(own[j], false, static_cast<uint32_t>(j));
            ++j;
        } else {
            append(before[repeated[i]], true, repeated[i]);
            ++i;
        }
    }
    return merged;
}

Planes merge_planes(const MergedLeaves& merged, const Planes* before, Planes own) {
    if (!merged.repeats_any) return own;
    Planes planes(own.size());
    for (size_t plane = 0; plane < planes.size(); ++plane) {
        planes[plane].reserve(merged.leaves.size());
        for (const MergedLeaves::Run& run : merged.runs) {
            const std::vector<int16_t>& from = run.is_repeated ? (*before)[plane] : own[plane];
            const auto first = from.begin() + run.first;
            planes[plane].insert(planes[plane].end(), first, first + run.count);
        }
    }
    return planes;
}

}  // namespace neuvv::stream
