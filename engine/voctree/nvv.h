// The .nvv file: a VOctree at rest. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv {

// Extra named chunks (four ASCII characters each) that ride along: the optimiser's state, later paint. A reader keeps
// what it does not know.
struct NvvChunk {
    std::string name;
    std::vector<uint8_t> bytes;
};

// Weights are stored as fp16 (out of range saturates), A and B as fp32. Atomic: the path holds the old or the new file.
// `compression` is zstd's level. Throws RuntimeFailure (disk) and asserts that defect_of(tree) is empty.
void write_nvv(const std::filesystem::path& path, const VOctree& tree, const std::vector<NvvChunk>& extra = {},
               int compression = 3);

// Throws InputError naming the file, the chunk and the mend; never trusts a size or an index in the file.
VOctree read_nvv(const std::filesystem::path& path, std::vector<NvvChunk>* extra = nullptr);

}  // namespace neuvv
