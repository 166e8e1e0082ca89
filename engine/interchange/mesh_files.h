// Meshes as .obj and .ply, a frame each. Both are written atomically and throw RuntimeFailure.
#pragma once

#include <filesystem>

#include "interchange/mesh_image.h"

namespace neuvv::interchange {

// NAME.obj, with NAME.mtl and NAME_texture.png beside it, which are written first. The mesh has a texture, or none
// where it is empty.
void write_mesh_obj(const std::filesystem::path& file, const ColouredMesh& mesh);
std::vector<std::filesystem::path> files_of_obj(const std::filesystem::path& file);

// Binary, little-endian: positions, normals, and sRGB colours of vertices. The mesh has colours.
void write_mesh_ply(const std::filesystem::path& file, const ColouredMesh& mesh);

}  // namespace neuvv::interchange
