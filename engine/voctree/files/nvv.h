// Reads and writes .nvv files, each a VOctree. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// An additional chunk of a file, for instance the optimiser's state, whose bytes this module does not interpret. Its
// name is four ASCII letters or digits, the first a lower-case letter, and differs from the names of the coarse tree's
// chunks and of the file's other chunks. It has at most 4 GiB.
struct NvvChunk {
    std::string name;
    std::vector<uint8_t> bytes;
};

// The same to be written; the bytes lie elsewhere.
struct NvvChunkView {
    std::string name;
    std::span<const uint8_t> bytes;
    NvvChunkView(std::string given_name, std::span<const uint8_t> given) : name(std::move(given_name)), bytes(given) {}
    explicit NvvChunkView(const NvvChunk& chunk) : name(chunk.name), bytes(chunk.bytes) {}
};

// Writes the file atomically: at any time the path has the complete old or new file. Weights are stored as fp16,
// clamped to its range, A and B as fp32. `compression` is zstd's level. `coarse` (coarse.h), which must have the same
// frames, fps and box, is written before the tree. Throws RuntimeFailure where the disk fails, where a tree has a
// defect_of (as a diverged training leaves behind), or where an extra chunk is invalid; the old file is then left as it
// was.
void write_nvv(const std::filesystem::path& path, const VOctree& tree, const std::vector<NvvChunkView>& extra = {},
               int compression = 3, const std::optional<VOctree>& coarse = std::nullopt);

// Reads the tree, and in `extra` the additional chunks. Throws InputError naming the file, the chunk and the fix; every
// size and index in the file is checked, and the result has no defect_of.
VOctree read_nvv(const std::filesystem::path& path, std::vector<NvvChunk>* extra = nullptr);

// Reads the coarse tree alone, with the same checks; the file behind it is not read. Nothing where the file has no
// coarse tree. Throws InputError as read_nvv.
std::optional<VOctree> read_nvv_coarse(const std::filesystem::path& path);

// The chunk HEAD, laid out as in the file.
struct NvvHeader {
    uint32_t node_levels, node_count, child_count, leaf_count;
    uint32_t bases, hh_degree, frames;
    float fps;
    glm::vec3 box_min, box_size;
};
NvvHeader header_of(const VOctree& tree);

struct NvvSummary {
    struct Chunk {
        std::string name;
        uint64_t raw_bytes, stored_bytes;
    };
    uint32_t version = 0;
    uint64_t file_bytes = 0;
    NvvHeader header{};
    std::vector<Chunk> chunks;  // in file order, without END
};

// Summarises a file from its headers alone: topology and weights are not read, and their checksums not verified. Throws
// InputError where the headers are damaged.
NvvSummary summarise_nvv(const std::filesystem::path& path);

}  // namespace neuvv::voctree
