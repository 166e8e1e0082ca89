// Writes .nvv files from the specification, independently of the engine's writer, so that a test can give invalid
// content valid checksums.
#pragma once

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "voctree/files/half.h"
#include "voctree/voctree.h"

namespace neuvv::test {

using Bytes = std::vector<uint8_t>;

template <typename T>
void append(Bytes& bytes, const T& value) {
    const auto* begin = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof value);
}

struct Chunk {
    std::string name;
    Bytes raw;
    uint32_t flags = 0;
    std::optional<uint64_t> claimed_raw_bytes = {};
    std::optional<Bytes> stored = {};  // instead of raw's zstd frame
};

inline Bytes compressed(const Bytes& raw) {
    Bytes stored(ZSTD_compressBound(raw.size()));
    stored.resize(ZSTD_compress(stored.data(), stored.size(), raw.data(), raw.size(), 1));
    return stored;
}

inline void append_chunk(Bytes& file, const Chunk& chunk, uint64_t& previous_checksum) {
    const Bytes stored = chunk.stored ? *chunk.stored : compressed(chunk.raw);
    Bytes hashed(chunk.name.begin(), chunk.name.end());
    append(hashed, chunk.flags);
    append(hashed, chunk.claimed_raw_bytes.value_or(chunk.raw.size()));
    append(hashed, uint64_t{stored.size()});
    file.insert(file.end(), hashed.begin(), hashed.end());
    hashed.insert(hashed.end(), stored.begin(), stored.end());
    previous_checksum = XXH3_64bits_withSeed(hashed.data(), hashed.size(), previous_checksum);
    append(file, previous_checksum);
    file.insert(file.end(), stored.begin(), stored.end());
}

inline Bytes nvv_of(const std::vector<Chunk>& chunks, uint32_t version = 3) {
    Bytes file = {0x89, 'N', 'V', 'V', 0x0d, 0x0a, 0x1a, 0x0a};
    append(file, version);
    uint64_t checksum = 0;
    for (const Chunk& chunk : chunks) append_chunk(file, chunk, checksum);
    append_chunk(file, {.name = "END ", .raw = {}, .stored = Bytes{}}, checksum);
    return file;
}

// The coding byte of a column: the smallest k of 0..24 for which all numbers times 2^k are 16-bit integers, else that
// of bits.
inline uint8_t coding_of(const std::vector<uint16_t>& halves) {
    for (uint8_t coding = 0; coding <= 24; ++coding) {
        const auto fits = [&](uint16_t half) {
            const double multiple = std::ldexp(static_cast<double>(voctree::float_from_half(half)), coding);
            return multiple == std::floor(multiple) && std::abs(multiple) <= 32767;
        };
        if (std::all_of(halves.begin(), halves.end(), fits)) return coding;
    }
    uint8_t shift = 0;
    while (std::all_of(halves.begin(), halves.end(), [&](uint16_t half) { return half % (2u << shift) == 0; })) ++shift;
    return static_cast<uint8_t>(128 + shift);
}

// Packs columns of halves; the steps 0, −1, 1, −2, … of a column are stored as 0, 1, 2, 3, …
inline Bytes columns_bytes(const std::vector<std::vector<uint16_t>>& columns) {
    Bytes bytes, low, high;
    for (const std::vector<uint16_t>& column : columns) {
        const uint8_t coding = coding_of(column);
        bytes.push_back(coding);
        int before = 0;
        for (const uint16_t half : column) {
            int number = half >> (coding & 127);
            if (coding < 128) {
                const int multiple = static_cast<int>(std::ldexp(voctree::float_from_half(half), coding));
                const int step = static_cast<int16_t>(multiple - before);
                before = multiple;
                number = step < 0 ? -2 * step - 1 : 2 * step;
            }
            low.push_back(static_cast<uint8_t>(number));
            high.push_back(static_cast<uint8_t>(number >> 8));
        }
    }
    bytes.insert(bytes.end(), low.begin(), low.end());
    bytes.insert(bytes.end(), high.begin(), high.end());
    return bytes;
}

// The nine chunks of a tree, which may have defects.
inline std::vector<Chunk> chunks_of(const voctree::VOctree& tree) {
    std::vector<Chunk> chunks;
    for (const char* name : {"HEAD", "NODE", "CHLD", "BASA", "BASB", "MASK", "WSIG", "WGAM", "WHHC"})
        chunks.push_back({.name = name, .raw = {}});
    for (const uint32_t value :
         {tree.node_levels, static_cast<uint32_t>(tree.nodes.size()), static_cast<uint32_t>(tree.children.size()),
          tree.leaf_count, tree.bases, tree.hh_degree, tree.frames})
        append(chunks[0].raw, value);
    append(chunks[0].raw, tree.fps);
    for (const glm::vec3& corner : {tree.box_min, tree.box_size})
        for (int axis = 0; axis < 3; ++axis) append(chunks[0].raw, corner[axis]);
    for (const TreeNode& node : tree.nodes)
        for (const uint32_t word : {node.mask_lo, node.mask_hi, node.first_child}) append(chunks[1].raw, word);
    for (const int shift : {0, 8, 16, 24})
        for (size_t i = 0; i < tree.children.size(); ++i)
            chunks[2].raw.push_back(
                static_cast<uint8_t>((tree.children[i] - (i > 0 ? tree.children[i - 1] : 0)) >> shift));
    for (const float value : tree.sigma_basis) append(chunks[3].raw, value);
    for (const float value : tree.gamma_basis) append(chunks[4].raw, value);
    const auto half = [&](uint32_t leaf, uint32_t weight) { return voctree::half_from_float(tree.leaf(leaf)[weight]); };
    const auto present = [&](uint32_t leaf, uint32_t basis) {
        return voctree::float_from_half(half(leaf, basis)) != 0 ||
               voctree::float_from_half(half(leaf, tree.bases + basis)) != 0;
    };
    for (uint32_t first = 0; first < tree.bases; first += 8)
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            uint8_t bits = 0;
            for (uint32_t i = 0; i < 8 && first + i < tree.bases; ++i)
                if (present(leaf, first + i)) bits = static_cast<uint8_t>(bits | 1 << i);
            chunks[5].raw.push_back(bits);
        }
    std::vector<std::vector<uint16_t>> columns[3];
    for (uint32_t weight = 0; weight < tree.weights_per_leaf(); ++weight) {
        const uint32_t kind = std::min(weight / tree.bases, 2u);
        std::vector<uint16_t>& column = columns[kind].emplace_back();
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            if (kind == 2 || present(leaf, weight % tree.bases)) column.push_back(half(leaf, weight));
    }
    for (size_t kind = 0; kind < 3; ++kind) chunks[6 + kind].raw = columns_bytes(columns[kind]);
    return chunks;
}

inline void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

inline Bytes read_bytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), {});
}

}  // namespace neuvv::test
