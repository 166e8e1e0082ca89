// Reads grids of OpenVDB files (https://www.openvdb.org). This is no wrapper of that library, which trusts its files:
// it takes sizes and masks as they are. Here all of them are checked.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace neuvv::interchange {

constexpr int kVdbBlockEdge = 8;  // voxels

// A cube of 8³ voxels, some of which are active.
struct VdbBlock {
    glm::ivec3 min{0};                 // index of its first voxel
    std::array<uint64_t, 8> active{};  // bit 8 y + z of word x says whether a voxel is
    size_t first = 0;                  // the value of its first active voxel, in the order of the bits
};

// A cube of active voxels of one value.
struct VdbTile {
    glm::ivec3 min{0};
    int edge = 1;  // voxels: 8, 128 or 4096
    size_t first = 0;
};

// A sparse grid of numbers, or of vectors of three.
struct VdbGrid {
    std::string name, grid_class;    // "fog volume", "level set" or others
    uint32_t channels = 1;           // 1 or 3
    glm::dmat4 world_from_index{1};  // in the file's units; a voxel's index is that of its centre
    std::vector<VdbBlock> blocks;    // they and the tiles overlap in hostile files only
    std::vector<VdbTile> tiles;
    std::vector<float> values;  // `channels` for each active voxel or tile; all are finite

    const float* value(size_t i) const { return &values[i * channels]; }
};

// Indices lie between −this and this.
constexpr int kMostVdbIndex = 1 << 23;

// Reads those grids of a file that have floats or vectors of floats as OpenVDB writes them since version 3 (2015),
// whole or as halves, packed or not, with maps that are affine and voxels of their own. Others are passed over, where
// the file says how long they are and has one that is read. Values that are not finite are 0. Throws InputError with
// the file and what is wrong.
std::vector<VdbGrid> read_vdb(const std::filesystem::path& file);
// The same for the bytes of a file; `file` is for errors.
std::vector<VdbGrid> parse_vdb(std::span<const uint8_t> bytes, const std::string& file);

}  // namespace neuvv::interchange
