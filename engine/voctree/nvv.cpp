#include "voctree/nvv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "voctree/chunk_file.h"
#include "voctree/half.h"

namespace neuvv {

namespace {

static_assert(sizeof(NvvHead) == 56);

enum ChunkIndex { kHead, kNode, kChld, kBasA, kBasB, kWSig, kWGam, kWHhc, kChunkCount };
// In file order: topology stands before the weights, so that a count of leaves is proven before memory is taken for
// them.
constexpr std::array<const char*, kChunkCount> kChunkNames = {"HEAD", "NODE", "CHLD", "BASA",
                                                              "BASB", "WSIG", "WGAM", "WHHC"};
constexpr uint64_t kMaxExtraBytes = uint64_t{4} << 30;
constexpr size_t kStoredNodeBytes = 12;
constexpr size_t kLeafBlock = 256;  // leaves converted together: their weights stay in the cache between planes

// Columns of the weight matrix that one chunk holds.
struct WeightRange {
    uint32_t first, count;
};

WeightRange weight_range(const VOctree& tree, int chunk) {
    if (chunk == kWSig) return {0, tree.bases};
    if (chunk == kWGam) return {tree.bases, tree.bases};
    return {2 * tree.bases, 3 * hh_count(tree.hh_degree)};
}

// Entries less the one before them, mostly 1, in four planes of bytes, low ones first.
std::vector<uint8_t> pack_children(const std::vector<uint32_t>& children) {
    std::vector<uint8_t> bytes(4 * children.size());
    uint32_t before = 0;
    for (size_t i = 0; i < children.size(); ++i) {
        const uint32_t step = children[i] - before;
        before = children[i];
        for (size_t plane = 0; plane < 4; ++plane)
            bytes[plane * children.size() + i] = static_cast<uint8_t>(step >> (8 * plane));
    }
    return bytes;
}

std::vector<uint32_t> unpack_children(const std::vector<uint8_t>& bytes) {
    std::vector<uint32_t> children(bytes.size() / 4);
    uint32_t before = 0;
    for (size_t i = 0; i < children.size(); ++i) {
        for (size_t plane = 0; plane < 4; ++plane)
            before += uint32_t{bytes[plane * children.size() + i]} << (8 * plane);
        children[i] = before;
    }
    return children;
}

// A plane is one weight of all leaves: first the low bytes of their halves, then the high bytes (which pack well).
std::vector<uint8_t> pack_planes(const VOctree& tree, WeightRange range) {
    const size_t leaves = tree.leaf_count, stride = tree.weights_per_leaf();
    std::vector<uint8_t> planes(2 * leaves * range.count);
    for (size_t begin = 0; begin < leaves; begin += kLeafBlock) {
        const size_t end = std::min(begin + kLeafBlock, leaves);
        for (size_t column = 0; column < range.count; ++column) {
            const float* weight = &tree.weights[begin * stride + range.first + column];
            uint8_t* low = &planes[2 * leaves * column];
            uint8_t* high = low + leaves;
            for (size_t leaf = begin; leaf < end; ++leaf, weight += stride) {
                const uint16_t half = half_from_float(*weight);
                low[leaf] = static_cast<uint8_t>(half);
                high[leaf] = static_cast<uint8_t>(half >> 8);
            }
        }
    }
    return planes;
}

void unpack_planes(VOctree& tree, WeightRange range, const std::vector<uint8_t>& planes) {
    const size_t leaves = tree.leaf_count, stride = tree.weights_per_leaf();
    for (size_t begin = 0; begin < leaves; begin += kLeafBlock) {
        const size_t end = std::min(begin + kLeafBlock, leaves);
        for (size_t column = 0; column < range.count; ++column) {
            float* weight = &tree.weights[begin * stride + range.first + column];
            const uint8_t* low = &planes[2 * leaves * column];
            const uint8_t* high = low + leaves;
            for (size_t leaf = begin; leaf < end; ++leaf, weight += stride)
                *weight = float_from_half(static_cast<uint16_t>(low[leaf] | high[leaf] << 8));
        }
    }
}

NvvHead head_of(const VOctree& tree) {
    return {tree.node_levels,
            static_cast<uint32_t>(tree.nodes.size()),
            static_cast<uint32_t>(tree.children.size()),
            tree.leaf_count,
            tree.bases,
            tree.hh_degree,
            tree.frames,
            tree.fps,
            tree.box_min,
            tree.box_size};
}

std::vector<uint8_t> pack_nodes(const VOctree& tree) {
    std::vector<uint8_t> bytes(kStoredNodeBytes * tree.nodes.size());
    for (size_t i = 0; i < tree.nodes.size(); ++i)
        std::memcpy(&bytes[kStoredNodeBytes * i], &tree.nodes[i], kStoredNodeBytes);
    return bytes;
}

// Bounds every count, so that sizes computed from them do not overflow.
NvvHead read_head(ChunkReader& file) {
    NvvHead head;
    std::memcpy(&head, file.take(sizeof head).data(), sizeof head);
    const struct {
        const char* name;
        uint32_t value, low, high;
    } limits[] = {
        {"node_levels", head.node_levels, 1, kMaxNodeLevels},
        {"node_count", head.node_count, 1, kMaxNodes},
        {"child_count", head.child_count, 0, 8 * kMaxLeaves + kMaxNodes},
        {"leaf_count", head.leaf_count, 0, kMaxLeaves},
        {"bases", head.bases, 1, kMaxBases},
        {"hh_degree", head.hh_degree, 0, kMaxHhDegree},
        {"frames", head.frames, 1, kMaxFrames},
    };
    for (const auto& limit : limits)
        if (limit.value < limit.low || limit.value > limit.high)
            file.fail(fmt::format("{} is {}, must be {} to {}", limit.name, limit.value, limit.low, limit.high),
                      "write the file again");
    return head;
}

void apply_head(VOctree& tree, const NvvHead& head) {
    tree.node_levels = head.node_levels;
    tree.leaf_count = head.leaf_count;
    tree.bases = head.bases;
    tree.hh_degree = head.hh_degree;
    tree.frames = head.frames;
    tree.fps = head.fps;
    tree.box_min = head.box_min;
    tree.box_size = head.box_size;
}

template <typename T>
void take_array(ChunkReader& file, std::vector<T>& array, uint64_t count) {
    const std::vector<uint8_t> bytes = file.take(count * sizeof(T));
    array.resize(count);
    if (count > 0) std::memcpy(array.data(), bytes.data(), bytes.size());
}

void read_chunk(ChunkReader& file, int chunk, NvvHead& head, VOctree& tree) {
    const uint64_t row_numbers = uint64_t{tree.frames} * tree.bases;
    switch (chunk) {
        case kHead:
            head = read_head(file);
            apply_head(tree, head);
            break;
        case kNode: {
            const std::vector<uint8_t> bytes = file.take(uint64_t{kStoredNodeBytes} * head.node_count);
            tree.nodes.resize(head.node_count);
            for (size_t i = 0; i < tree.nodes.size(); ++i)
                std::memcpy(&tree.nodes[i], &bytes[kStoredNodeBytes * i], kStoredNodeBytes);
            break;
        }
        case kChld: {
            tree.children = unpack_children(file.take(uint64_t{4} * head.child_count));
            const std::string defect = defect_of_topology(tree);
            if (!defect.empty()) file.fail(defect, "write the file again");
            break;
        }
        case kBasA:
            take_array(file, tree.sigma_basis, row_numbers);
            break;
        case kBasB:
            take_array(file, tree.gamma_basis, row_numbers);
            break;
        default: {
            const WeightRange range = weight_range(tree, chunk);
            const std::vector<uint8_t> planes = file.take(uint64_t{2} * tree.leaf_count * range.count);
            tree.weights.resize(size_t{tree.leaf_count} * tree.weights_per_leaf());
            unpack_planes(tree, range, planes);
        }
    }
}

}  // namespace

void write_nvv(const std::filesystem::path& path, const VOctree& tree, const std::vector<NvvChunk>& extra,
               int compression) {
    const auto refuse = [&](const std::string& problem) {
        throw RuntimeFailure(fmt::format("{}: not written: {}", path.string(), problem));
    };
    const std::string defect = defect_of(tree);
    if (!defect.empty()) refuse(defect);
    for (const NvvChunk& chunk : extra) {
        if (!is_chunk_name(chunk.name) || !is_ancillary(chunk.name))
            refuse("an extra chunk's name is four letters or digits, the first a lower-case letter");
        if (chunk.bytes.size() > kMaxExtraBytes) refuse(fmt::format("chunk {} is larger than 4 GiB", chunk.name));
    }
    write_file_atomically(path, [&](const ByteSink& sink) {
        ChunkWriter file(path.string(), sink, compression);
        const NvvHead head = head_of(tree);
        file.add(kChunkNames[kHead], &head, sizeof head);
        const std::vector<uint8_t> nodes = pack_nodes(tree);
        file.add(kChunkNames[kNode], nodes.data(), nodes.size());
        const std::vector<uint8_t> children = pack_children(tree.children);
        file.add(kChunkNames[kChld], children.data(), children.size());
        file.add(kChunkNames[kBasA], tree.sigma_basis.data(), tree.sigma_basis.size() * sizeof(float));
        file.add(kChunkNames[kBasB], tree.gamma_basis.data(), tree.gamma_basis.size() * sizeof(float));
        for (int chunk = kWSig; chunk <= kWHhc; ++chunk) {
            const std::vector<uint8_t> planes = pack_planes(tree, weight_range(tree, chunk));
            file.add(kChunkNames[static_cast<size_t>(chunk)], planes.data(), planes.size());
        }
        for (const NvvChunk& chunk : extra) file.add(chunk.name, chunk.bytes.data(), chunk.bytes.size());
        file.finish();
    });
}

VOctree read_nvv(const std::filesystem::path& path, std::vector<NvvChunk>* extra) {
    ChunkReader file(path);
    VOctree tree;
    NvvHead head{};
    std::vector<NvvChunk> found;
    size_t done = 0;
    ChunkHeader chunk;
    while (file.next(chunk)) {
        const bool known = std::find(kChunkNames.begin(), kChunkNames.end(), chunk.name) != kChunkNames.end();
        if (known || done == kHead) {
            if (done == kChunkCount || chunk.name != kChunkNames[done])
                file.fail_damaged(done == kChunkCount ? "is one too many"
                                                      : fmt::format("stands where {} must", kChunkNames[done]));
            read_chunk(file, static_cast<int>(done++), head, tree);
        } else if (!is_ancillary(chunk.name)) {
            file.fail("is unknown to this program", "open the file with a newer neuvv");
        } else if (chunk.raw_bytes > kMaxExtraBytes) {
            file.fail_damaged("is larger than 4 GiB");
        } else if (extra) {
            found.push_back({chunk.name, file.take(chunk.raw_bytes)});
        } else {
            file.skip(true);
        }
    }
    if (done != kChunkCount) file.fail_damaged(fmt::format("comes before chunk {}", kChunkNames[done]));
    const std::string defect = defect_of(tree);
    if (!defect.empty()) throw InputError(path.string(), "", defect, "write the file again");
    if (extra) *extra = std::move(found);
    return tree;
}

NvvSummary summarise_nvv(const std::filesystem::path& path) {
    ChunkReader file(path);
    NvvSummary summary;
    summary.version = kNvvVersion;
    summary.file_bytes = file.file_bytes();
    ChunkHeader chunk;
    while (file.next(chunk)) {
        const bool is_head = chunk.name == kChunkNames[kHead];
        if (summary.chunks.empty() != is_head) file.fail_damaged("HEAD must stand first, and once");
        summary.chunks.push_back({chunk.name, chunk.raw_bytes, chunk.stored_bytes});
        if (is_head)
            summary.head = read_head(file);
        else
            file.skip(false);
    }
    if (summary.chunks.empty()) file.fail_damaged("comes before chunk HEAD");
    return summary;
}

}  // namespace neuvv
