// A clip cut into segments that show the same, frame by frame; with an overlap, also between two segments.
#pragma once

#include <filesystem>
#include <vector>

#include "voctree/files/clip_index.h"
#include "voctree/files/nvv.h"
#include "voctree/frames.h"

namespace neuvv {

inline void write_segmented_copy(const voctree::VOctree& tree, const std::vector<uint32_t>& lengths,
                                 const std::filesystem::path& folder, uint32_t overlap = 0) {
    std::filesystem::create_directory(folder);
    voctree::ClipIndex index{tree.fps, {}};
    uint32_t first = 0;
    for (const uint32_t length : lengths) {
        const uint32_t more = first + length < tree.frames ? overlap : 0;
        index.segments.push_back({folder / voctree::segment_file_name(first), first, length, more});
        voctree::write_nvv(index.segments.back().file, voctree::frames_of(tree, first, length + more));
        first += length;
    }
    voctree::write_clip_index(folder, index);
}

}  // namespace neuvv
