// The .nvv file: a VOctree at rest. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Extra named chunks that ride along: the optimiser's state, later paint. A reader keeps what it does not know. A name
// is four ASCII letters or digits, the first a lower-case letter, and none of the coarse tree's; each at most once in a
// file, at most 4 GiB of bytes.
struct NvvChunk {
    std::string name;
    std::vector<uint8_t> bytes;
};

// Weights are stored as fp16 (out of range saturates), A and B as fp32. Atomic: the path holds the old or the new file.
// `compression` is zstd's level. Throws RuntimeFailure (the disk; a tree with a defect_of, as a diverged training
// leaves behind; an extra chunk with a bad name) and then leaves the old file. `coarse` (coarse.h), of the same clip
// and box, goes before the tree.
void write_nvv(const std::filesystem::path& path, const VOctree& tree, const std::vector<NvvChunk>& extra = {},
               int compression = 3, const std::optional<VOctree>& coarse = std::nullopt);

// Throws InputError naming the file, the chunk and the fix; never trusts a size or an index in the file.
VOctree read_nvv(const std::filesystem::path& path, std::vector<NvvChunk>* extra = nullptr);

// The coarse tree alone, as well checked, from the file's first bytes: the rest is not looked at. Nothing where the
// file has none. Throws InputError.
std::optional<VOctree> read_nvv_coarse(const std::filesystem::path& path);

// The chunk HEAD as it stands in the file.
struct NvvHead {
    uint32_t node_levels, node_count, child_count, leaf_count;
    uint32_t bases, hh_degree, frames;
    float fps;
    glm::vec3 box_min, box_size;
};
NvvHead head_of(const VOctree& tree);

struct NvvSummary {
    struct Chunk {
        std::string name;
        uint64_t raw_bytes, stored_bytes;
    };
    uint32_t version = 0;
    uint64_t file_bytes = 0;
    NvvHead head{};
    std::vector<Chunk> chunks;  // in file order, END left out
};

// What a file holds, from its headers alone: no topology or weights are read, nor their checksums verified. Throws
// InputError for what it does read.
NvvSummary summarise_nvv(const std::filesystem::path& path);

}  // namespace neuvv::voctree
