// Textured meshes in glTF.
#pragma once

#include "interchange/mesh/mesh_image.h"
#include "stage/gltf/glb_writer.h"

namespace neuvv::interchange {

// A .glb that grows by a frame at a time.
class MeshGlb {
  public:
    MeshGlb();
    // The mesh has a texture, or no triangles.
    void add(const ColouredMesh& frame);
    // A node for each frame, as gltf_frames.h has it; their materials are unlit, as the textures hold light. Written
    // atomically. Throws InputError where it would have more than 4 GiB, RuntimeFailure where it cannot be written.
    void write(const std::filesystem::path& file, double fps, const glm::dvec3& origin = glm::dvec3(0));

  private:
    stage::GlbWriter glb_;
    std::vector<nlohmann::ordered_json> meshes_;
};

}  // namespace neuvv::interchange
