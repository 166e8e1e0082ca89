// A glTF scene at a time: animation, skinning and morphing on the CPU, in double precision up to the vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "stage/gltf_scene.h"

namespace neuvv::stage {

constexpr int32_t kNoAnimation = -1;    // the scene as its nodes say
constexpr int32_t kAllAnimations = -2;  // all of the file at once, as on a stage; of two on one node the later counts

struct PosedScene {
    std::vector<glm::dmat4> world_from_node;              // by node
    std::vector<std::vector<glm::dmat4>> joint_matrices;  // by skin, by joint: world from bind pose
    std::vector<std::vector<float>> morph_weights;        // by node, one a morph target
};

// `animation` is an index, kNoAnimation or kAllAnimations; time_s is clamped to each channel's keys.
PosedScene pose_scene(const GltfScene& scene, int32_t animation, double time_s);

struct PosedVertices {
    std::vector<glm::vec3> positions;  // world, metres
    std::vector<glm::vec3> normals;    // world, unit, outward
    std::vector<glm::vec4> tangents;   // world, as GltfPrimitive's; empty where it has none
    bool mirrored = false;             // the node mirrors: triangles are clockwise from outside
};

// World-space vertices of one primitive of the node's mesh. `out` is overwritten; its memory is reused.
void pose_vertices(const GltfScene& scene, const PosedScene& pose, uint32_t node, const GltfPrimitive& primitive,
                   PosedVertices& out);

// World-space box around everything drawn at all these times: min, max. Throws InputError where nothing is drawn or
// a position is not finite.
std::pair<glm::dvec3, glm::dvec3> bounds_over(const GltfScene& scene, int32_t animation,
                                              const std::vector<double>& times_s);

}  // namespace neuvv::stage
