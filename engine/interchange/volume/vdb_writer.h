// A frame as an OpenVDB file.
#pragma once

#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>

#include "slice/slice.h"

namespace neuvv::interchange {

struct VdbOptions {
    // Voxels are the cells of this depth; 0: those of the frame's finest leaves. No leaf may be finer (assert).
    uint32_t depth = 0;
    // Where it is given, there is a level set "surface", too: the distance in metres, negative inside and up to three
    // voxels, to where the opacity along a voxel's edge, interpolated between voxels, falls below this (0 to 1).
    std::optional<float> surface_opacity{};
    // Of all grids about the origin: the volume's axes are not those of the world. neuvv::interchange::volume_of
    // refuses grids that are turned.
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 origin{0};  // where the volume's origin is then, in the doubles of the grids' transforms
};

// Writes the fog volume "density", in 1/m, and the vectors "Cd": the mean of a leaf's colour over all directions, in
// linear light. Lengths are metres, +Y is up. Larger leaves are tiles where OpenVDB has tiles of their size. "Cd" goes
// on for one voxel beyond the density, as programs interpolate. Both are stored as halves.
//
// Written atomically. Throws InputError where a level set is asked for and the volume's cells are no cubes,
// RuntimeFailure where the file cannot be written.
void write_vdb(const std::filesystem::path& file, const slice::Slice& volume, const VdbOptions& options = {});
// The bytes of the file.
std::string vdb_bytes(const slice::Slice& volume, const VdbOptions& options = {});

// Whether cells are cubes up to rounding, as level sets need it.
bool has_cubic_cells(const slice::Slice& volume);

// About, with a level set.
constexpr size_t kVdbBytesOfLeaf = 40;

}  // namespace neuvv::interchange
