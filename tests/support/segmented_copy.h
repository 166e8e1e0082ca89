// A clip cut into segments that show the same, frame by frame.
#pragma once

#include <filesystem>
#include <vector>

#include "voctree/clip_index.h"
#include "voctree/nvv.h"

namespace neuvv {

// The tree in some of its frames: with the same leaves and weights, and the rows of these frames.
inline voctree::VOctree tree_of_frames(voctree::VOctree tree, uint32_t first, uint32_t count) {
    for (std::vector<float>* rows : {&tree.sigma_basis, &tree.gamma_basis}) {
        const auto begin = rows->begin() + static_cast<ptrdiff_t>(size_t{first} * tree.bases);
        *rows = std::vector<float>(begin, begin + static_cast<ptrdiff_t>(size_t{count} * tree.bases));
    }
    tree.frames = count;
    return tree;
}

inline void write_segmented_copy(const voctree::VOctree& tree, const std::vector<uint32_t>& lengths,
                                 const std::filesystem::path& folder) {
    std::filesystem::create_directory(folder);
    voctree::ClipIndex index{tree.fps, {}};
    uint32_t first = 0;
    for (const uint32_t length : lengths) {
        index.segments.push_back({folder / voctree::segment_file_name(first), first, length});
        voctree::write_nvv(index.segments.back().file, tree_of_frames(tree, first, length));
        first += length;
    }
    voctree::write_clip_index(folder, index);
}

}  // namespace neuvv
