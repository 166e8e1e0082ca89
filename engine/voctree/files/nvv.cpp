#include "voctree/files/nvv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/pack.h"

namespace neuvv::voctree {

namespace {

static_assert(sizeof(NvvHeader) == 56);

enum ChunkIndex { kHead, kNode, kChld, kBasA, kBasB, kMask, kWSig, kWGam, kWHhc, kChunkCount };
// The chunks in file order. The topology comes before the weights, so that the number of leaves is verified before
// memory is allocated for their weights.
using ChunkNames = std::array<const char*, kChunkCount>;
constexpr ChunkNames kChunkNames = {"HEAD", "NODE", "CHLD", "BASA", "BASB", "MASK", "WSIG", "WGAM", "WHHC"};
// The chunks of the coarse tree: ancillary, so that a reader that does not know them skips them.
constexpr ChunkNames kCoarseNames = {"hEAD", "nODE", "cHLD", "bASA", "bASB", "mASK", "wSIG", "wGAM", "wHHC"};
constexpr uint64_t kMaxExtraBytes = uint64_t{4} << 30;
constexpr size_t kStoredNodeBytes = 12;

bool is_one_of(const ChunkNames& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<uint8_t> pack_nodes(const VOctree& tree) {
    std::vector<uint8_t> bytes(kStoredNodeBytes * tree.nodes.size());
    for (size_t i = 0; i < tree.nodes.size(); ++i)
        std::memcpy(&bytes[kStoredNodeBytes * i], &tree.nodes[i], kStoredNodeBytes);
    return bytes;
}

// Checks that every count is within its bounds, so that sizes that are computed from them do not overflow.
NvvHeader read_nvv_header(ChunkReader& file) {
    NvvHeader header{};
    std::memcpy(&header, file.take(sizeof header).data(), sizeof header);
    const struct {
        const char* name;
        uint32_t value, low, high;
    } limits[] = {
        {"node_levels", header.node_levels, 1, kMaxNodeLevels},
        {"node_count", header.node_count, 1, kMaxNodes},
        {"child_count", header.child_count, 0, 8 * kMaxLeaves + kMaxNodes},
        {"leaf_count", header.leaf_count, 0, kMaxLeaves},
        {"bases", header.bases, 1, kMaxBases},
        {"hh_degree", header.hh_degree, 0, kMaxHhDegree},
        {"frames", header.frames, 1, kMaxFrames},
    };
    for (const auto& limit : limits)
        if (limit.value < limit.low || limit.value > limit.high)
            file.fail(fmt::format("{} is {}, must be {} to {}", limit.name, limit.value, limit.low, limit.high),
                      "write the file again");
    return header;
}

void apply_header(VOctree& tree, const NvvHeader& header) {
    tree.node_levels = header.node_levels;
    tree.leaf_count = header.leaf_count;
    tree.bases = header.bases;
    tree.hh_degree = header.hh_degree;
    tree.frames = header.frames;
    tree.fps = header.fps;
    tree.box_min = header.box_min;
    tree.box_size = header.box_size;
}

template <typename T>
void take_array(ChunkReader& file, std::vector<T>& array, uint64_t count) {
    const std::vector<uint8_t> bytes = file.take(count * sizeof(T));
    array.resize(count);
    if (count > 0) std::memcpy(array.data(), bytes.data(), bytes.size());
}

WeightRange weight_range(const VOctree& tree, int chunk) {
    return chunk == kWSig ? sigma_range(tree) : chunk == kWGam ? gamma_range(tree) : colour_range(tree);
}

// The size of all weights as halves. Chunks leave out weights that are 0, so a reader needs this much memory even where
// the chunks are smaller.
uint64_t weight_bytes(const VOctree& tree) {
    return uint64_t{2} * tree.leaf_count * tree.weights_per_leaf();
}

void read_presence(ChunkReader& file, VOctree& tree, std::vector<uint8_t>& presence) {
    presence = file.take(uint64_t{(tree.bases + 7) / 8} * tree.leaf_count);
    if (!presence_fits(tree, presence)) file.fail("names a basis that does not exist", "write the file again");
    file.claim(weight_bytes(tree));
    tree.weights.resize(size_t{tree.leaf_count} * tree.weights_per_leaf());
}

// A tree whose first `done` chunks have been read.
struct PartialTree {
    VOctree tree;
    NvvHeader header{};
    std::vector<uint8_t> presence;
    size_t done = 0;
};

// Reads the tree's next chunk, which the file has opened.
void read_chunk(ChunkReader& file, PartialTree& part) {
    VOctree& tree = part.tree;
    NvvHeader& header = part.header;
    std::vector<uint8_t>& presence = part.presence;
    const auto chunk = static_cast<int>(part.done++);
    const uint64_t row_numbers = uint64_t{tree.frames} * tree.bases;
    switch (chunk) {
        case kHead:
            header = read_nvv_header(file);
            apply_header(tree, header);
            break;
        case kNode: {
            const std::vector<uint8_t> bytes = file.take(uint64_t{kStoredNodeBytes} * header.node_count);
            tree.nodes.resize(header.node_count);
            for (size_t i = 0; i < tree.nodes.size(); ++i)
                std::memcpy(&tree.nodes[i], &bytes[kStoredNodeBytes * i], kStoredNodeBytes);
            break;
        }
        case kChld: {
            tree.children = unpack_children(file.take(uint64_t{4} * header.child_count));
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
        case kMask:
            read_presence(file, tree, presence);
            break;
        default: {
            const WeightRange range = weight_range(tree, chunk);
            const std::vector<uint8_t> bytes = file.take(packed_weight_bytes(tree, range, presence));
            if (!unpack_weights(tree, range, presence, bytes))
                file.fail("has a column of unknown coding", "write the file again");
        }
    }
}

void add_header(ChunkWriter& file, const VOctree& tree, const ChunkNames& names) {
    const NvvHeader header = header_of(tree);
    file.add(names[kHead], &header, sizeof header);
}

// Writes all chunks of a tree but the header.
void add_body(ChunkWriter& file, const VOctree& tree, const ChunkNames& names) {
    const std::vector<uint8_t> nodes = pack_nodes(tree);
    file.add(names[kNode], nodes.data(), nodes.size());
    const std::vector<uint8_t> children = pack_children(tree.children);
    file.add(names[kChld], children.data(), children.size());
    file.add(names[kBasA], tree.sigma_basis.data(), tree.sigma_basis.size() * sizeof(float));
    file.add(names[kBasB], tree.gamma_basis.data(), tree.gamma_basis.size() * sizeof(float));
    const std::vector<uint8_t> presence = pack_presence(tree);
    file.add(names[kMask], presence.data(), presence.size());
    file.claim(weight_bytes(tree));
    for (int chunk = kWSig; chunk <= kWHhc; ++chunk) {
        const std::vector<uint8_t> bytes = pack_weights(tree, weight_range(tree, chunk), presence);
        file.add(names[static_cast<size_t>(chunk)], bytes.data(), bytes.size());
    }
}

// Whether one tree may replace the other while the clip is played.
bool same_clip(const NvvHeader& a, const NvvHeader& b) {
    return a.frames == b.frames && a.fps == b.fps && a.box_min == b.box_min && a.box_size == b.box_size;
}

// What a reader would refuse in the file to be written, or an empty string.
std::string defect_of_file(const VOctree& tree, const std::vector<NvvChunkView>& extra,
                           const std::optional<VOctree>& coarse) {
    const std::string defect = defect_of(tree);
    if (!defect.empty()) return defect;
    for (const NvvChunkView& chunk : extra) {
        if (!is_chunk_name(chunk.name) || !is_ancillary(chunk.name))
            return "an extra chunk's name is four letters or digits, the first a lower-case letter";
        if (is_one_of(kCoarseNames, chunk.name)) return fmt::format("chunk {} is the coarse tree's", chunk.name);
        if (chunk.bytes.size() > kMaxExtraBytes) return fmt::format("chunk {} is larger than 4 GiB", chunk.name);
    }
    if (!coarse) return "";
    const std::string coarse_defect = defect_of(*coarse);
    if (!coarse_defect.empty()) return "the coarse tree: " + coarse_defect;
    if (!same_clip(header_of(tree), header_of(*coarse))) return "the coarse tree has another clip or box";
    if (coarse->leaf_count > tree.leaf_count) return "the coarse tree has more leaves than the tree";
    if (weight_bytes(*coarse) > kMaxExtraBytes) return "the coarse tree is larger than 4 GiB";
    return "";
}

void expect_no_paint(const std::filesystem::path& path) {
    if (content_of(path) == FileContent::kPaint)
        throw InputError(path.string(), "", "is a layer of paint, not a clip", "name the .nvv that it was painted on");
}

}  // namespace

NvvHeader header_of(const VOctree& tree) {
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

void write_nvv(const std::filesystem::path& path, const VOctree& tree, const std::vector<NvvChunkView>& extra,
               int compression, const std::optional<VOctree>& coarse) {
    assert(!tree.has_srgb_colours && "a .nvv has linear colours");
    const std::string defect = defect_of_file(tree, extra, coarse);
    if (!defect.empty()) throw RuntimeFailure(fmt::format("{}: not written: {}", path.string(), defect));
    write_file_atomically(path, [&](const ByteSink& sink) {
        ChunkWriter file(path.string(), sink, compression);
        add_header(file, tree, kChunkNames);
        if (coarse) {
            add_header(file, *coarse, kCoarseNames);
            add_body(file, *coarse, kCoarseNames);
        }
        add_body(file, tree, kChunkNames);
        for (const NvvChunkView& chunk : extra) file.add(chunk.name, chunk.bytes.data(), chunk.bytes.size());
        file.finish();
    });
}

VOctree read_nvv(const std::filesystem::path& path, std::vector<NvvChunk>* extra) {
    expect_no_paint(path);
    ChunkReader file(path);
    PartialTree part;
    std::vector<NvvChunk> found;
    ChunkHeader chunk;
    while (file.next(chunk)) {
        if (is_one_of(kChunkNames, chunk.name) || part.done == kHead) {
            if (part.done == kChunkCount || chunk.name != kChunkNames[part.done])
                file.fail_damaged(part.done == kChunkCount
                                      ? "is one too many"
                                      : fmt::format("is where chunk {} must be", kChunkNames[part.done]));
            read_chunk(file, part);
        } else if (!is_ancillary(chunk.name)) {
            file.fail("is unknown to this program", "open the file with a newer neuvv");
        } else if (chunk.raw_bytes > kMaxExtraBytes) {
            file.fail_damaged("is larger than 4 GiB");
        } else if (extra && !is_one_of(kCoarseNames, chunk.name)) {
            found.push_back({chunk.name, file.take(chunk.raw_bytes)});
        } else {
            file.skip(true);
        }
    }
    if (part.done != kChunkCount) file.fail_damaged(fmt::format("comes before chunk {}", kChunkNames[part.done]));
    const std::string defect = defect_of(part.tree);
    if (!defect.empty()) throw InputError(path.string(), "", defect, "write the file again");
    if (extra) *extra = std::move(found);
    return std::move(part.tree);
}

std::optional<VOctree> read_nvv_coarse(const std::filesystem::path& path) {
    ChunkReader file(path);
    ChunkHeader chunk;
    if (!file.next(chunk) || chunk.name != kChunkNames[kHead]) file.fail_damaged("is where chunk HEAD must be");
    const NvvHeader whole = read_nvv_header(file);
    PartialTree part;
    for (const char* name : kCoarseNames) {
        const bool there = file.next(chunk) && chunk.name == name;
        if (!there && part.done == kHead) return std::nullopt;
        if (!there) file.fail_damaged(fmt::format("is where chunk {} must be", name));
        if (chunk.raw_bytes > kMaxExtraBytes) file.fail_damaged("is larger than 4 GiB");
        read_chunk(file, part);
        if (part.done > kHead + 1) continue;
        if (!same_clip(whole, part.header)) file.fail("has another clip or box than HEAD", "write the file again");
        if (part.header.leaf_count > whole.leaf_count) file.fail("has more leaves than HEAD", "write the file again");
    }
    const std::string defect = defect_of(part.tree);
    if (!defect.empty()) throw InputError(path.string(), "the coarse tree", defect, "write the file again");
    return std::move(part.tree);
}

NvvSummary summarise_nvv(const std::filesystem::path& path) {
    expect_no_paint(path);
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
            summary.header = read_nvv_header(file);
        else
            file.skip(false);
    }
    if (summary.chunks.empty()) file.fail_damaged("comes before chunk HEAD");
    return summary;
}

}  // namespace neuvv::voctree
