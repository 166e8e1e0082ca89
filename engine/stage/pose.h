// Evaluates a glTF scene at a time: animation, skinning and morphing on the CPU. Everything but the vertices of the
// result is in double precision.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

constexpr int32_t kNoAnimation = -1;    // the nodes' own transforms
constexpr int32_t kAllAnimations = -2;  // all animations at once; where two move one property, the later one wins

struct PosedScene {
    std::vector<glm::dmat4> world_from_node;              // by node
    std::vector<std::vector<glm::dmat4>> joint_matrices;  // by skin, by joint: world from bind pose
    std::vector<std::vector<float>> morph_weights;        // by node, one for each morph target
};

// `animation` is an index into scene.animations, kNoAnimation or kAllAnimations; `time_s` is clamped to each channel's
// keys.
PosedScene pose_scene(const GltfScene& scene, int32_t animation, double time_s);

struct PosedVertices {
    std::vector<glm::vec3> positions;  // world, metres
    std::vector<glm::vec3> normals;    // world, unit, outward
    std::vector<glm::vec4> tangents;   // world, as GltfPrimitive::tangents; empty where the primitive has none
    bool mirrored = false;             // the node's transform mirrors: triangles are clockwise from outside
};

// Computes the vertices of one primitive of the node's mesh. `out` is overwritten; its memory is reused.
void pose_vertices(const GltfScene& scene, const PosedScene& pose, uint32_t node, const GltfPrimitive& primitive,
                   PosedVertices& out);

// The axis-aligned box (min, max; world metres) around all meshes that are drawn at these times. Throws InputError
// where nothing is drawn or a vertex is not at a finite position.
std::pair<glm::dvec3, glm::dvec3> bounds_over(const GltfScene& scene, int32_t animation,
                                              const std::vector<double>& times_s);

}  // namespace neuvv::stage
