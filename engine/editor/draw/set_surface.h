// The triangles of a stage's set at a time, on the host, and where rays meet them.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "base/box.h"
#include "stage/pose.h"

namespace neuvv::editor {

struct SetHit {
    uint32_t node = 0;      // of the mesh
    double distance_m = 0;  // along the ray, in the world
};

// Takes 24 bytes for each kRun triangles, and the positions of meshes that are skinned or morphed.
class SetSurface {
  public:
    // Takes the set as it is posed. Costs little where it draws the same meshes as in the last call: then only meshes
    // that are skinned or morphed, and have moved since, are gone through.
    void follow(const stage::GltfScene& scene, const stage::PosedScene& pose);
    // The nearest triangle that a ray (world) meets, seen from either side; nullopt where it meets none.
    std::optional<SetHit> meet(const Ray& ray) const;

  private:
    static constexpr size_t kRun = 64;  // triangles that follow each other in a mesh, which have a box of their own
    struct Bounds {
        glm::vec3 low{INFINITY}, high{-INFINITY};
    };
    // One primitive of one node, in a space of its own: that of the node; or the world, where each vertex moves by
    // itself, or the node is flattened, so that a ray of the world is none of the node.
    struct Piece {
        uint32_t node = 0;
        const stage::GltfPrimitive* primitive = nullptr;
        bool has_skin = false, is_rigid = true;
        glm::dmat4 piece_from_world{1};
        std::vector<glm::dmat4> joints;  // of `posed`: the joints' transforms, or the node's; empty where rigid
        std::vector<float> weights;      // of `posed`: those of the morph targets
        stage::PosedVertices posed;      // empty where rigid
        Bounds bounds;
        std::vector<Bounds> runs;
        const std::vector<glm::vec3>& positions() const { return is_rigid ? primitive->positions : posed.positions; }
    };
    bool lists_pieces_of(const stage::GltfScene& scene) const;
    void list_pieces(const stage::GltfScene& scene);
    static void bound(Piece& piece);
    static void pose_piece(Piece& piece, const stage::GltfScene& scene, const stage::PosedScene& pose);
    static void meet_piece(const Piece& piece, const Ray& ray, SetHit& nearest);
    stage::SharedList<stage::GltfMesh> meshes_;  // which the pieces' primitives belong to
    std::vector<Piece> pieces_;
};

}  // namespace neuvv::editor
