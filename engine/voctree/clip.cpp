#include "voctree/clip.h"

#include <cstring>
#include <fstream>

#include "voctree/nvv.h"
#include "voctree/plenoctree.h"

namespace neuvv::voctree {

bool has_clip_ending(const std::filesystem::path& path) {
    return path.extension() == ".nvv" || path.extension() == ".npz";
}

bool is_plenoctree(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    char magic[4] = {};
    std::ifstream(path, std::ios::binary).read(magic, sizeof(magic));
    return std::memcmp(magic, "PK\3\4", sizeof(magic)) == 0;
}

VOctree read_clip(const std::filesystem::path& path) {
    return is_plenoctree(path) ? read_plenoctree(path) : read_nvv(path);
}

ClipHead read_clip_head(const std::filesystem::path& path) {
    if (is_plenoctree(path)) {
        const PlenoctreeBox box = read_plenoctree_box(path);
        return {1, VOctree{}.fps, box.min, box.size};
    }
    const NvvHead head = summarise_nvv(path).head;
    return {head.frames, head.fps, head.box_min, head.box_size};
}

}  // namespace neuvv::voctree
