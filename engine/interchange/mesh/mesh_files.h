// Meshes as .obj and .ply, a frame each. Both are written atomically and throw RuntimeFailure.
#pragma once

#include <filesystem>

#include "interchange/mesh/mesh_image.h"

namespace neuvv::interchange {

// NAME.obj, with NAME.mtl and NAME_texture.png beside it, which are written first. The mesh has a texture, or none
// where it is empty. `origin` is added to positions in double precision.
void write_mesh_obj(const std::filesystem::path& file, const ColouredMesh& mesh,
                    const glm::dvec3& origin = glm::dvec3(0));
std::vector<std::filesystem::path> files_of_obj(const std::filesystem::path& file);

// Binary, little-endian: positions, normals, and sRGB colours of vertices. The mesh has colours. Positions are doubles
// where there is an `origin`, which is added to them.
void write_mesh_ply(const std::filesystem::path& file, const ColouredMesh& mesh,
                    const glm::dvec3& origin = glm::dvec3(0));

}  // namespace neuvv::interchange
