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
    std::string type;                // of the file's values: "float", "bool", "vec3d"
    std::string unread;              // why it has no values here: "is of points"; empty where it was read
    uint32_t channels = 1;           // 1 or 3
    glm::dmat4 world_from_index{1};  // in the file's units; a voxel's index is that of its centre
    std::vector<VdbBlock> blocks;    // they and the tiles overlap in hostile files only
    std::vector<VdbTile> tiles;
    std::vector<float> values;  // `channels` for each active voxel or tile, all finite

    const float* value(size_t i) const { return &values[i * channels]; }
    uint64_t voxel_count() const;  // those that are active
};

struct VdbFile {
    std::string creator;  // "Blender/OpenVDBWriter"; empty where the file does not say so
    std::vector<VdbGrid> grids;
};

// Indices lie between −this and this.
constexpr int kMostVdbIndex = 1 << 23;

// Reads grids as OpenVDB writes them since version 3 (2015), packed or not, whole or as halves, with affine maps: of
// float, double, half, int32, int64, bool (true is 1) and mask (active is 1), and of vectors vec3s, vec3d and vec3i. Of
// others, and of those with maps that are not affine, the name, the type and the reason are kept, where the file says
// how long they are. What is no number is 0, what is infinite or too large for a float is cut to ±kMostVdbValue. Throws
// InputError with the file and what is wrong.
VdbFile read_vdb(const std::filesystem::path& file);
// The same for the bytes of a file; `file` is for errors.
VdbFile parse_vdb(std::span<const uint8_t> bytes, const std::string& file);

constexpr float kMostVdbValue = 1e30f;

}  // namespace neuvv::interchange
