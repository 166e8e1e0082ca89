// What a stage's document says, as plain values: the reading side of operations.h.
//
// Whoever shows or edits a stage asks here and reads no JSON. Each function looks at the document itself, so an edit is
// seen in the frame after it, before a Stage has been made of the document. Lights are in light_values.h, performers on
// a time line in tracks.h, layers of paint in paint_layers.h.
//
// A document is expected whose structure is sound, as expect_sound_document promises and as every operation leaves it:
// what glTF and our extensions define has its type, indices name what exists, no node is below itself. Everything that
// may be missing may be missing; then the default of glTF or of our extension is the answer. What only other programs
// define may be anything. A node that does not exist has nothing on it (where the answer is optional); everything else
// that is asked about it throws InputError. Numbers are as they were written: where one of our extensions has one out
// of its range, performer_on, stage_settings_of and camera_path_of throw InputError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stage/camera_path.h"
#include "stage/gltf_scene.h"
#include "stage/performer_settings.h"
#include "stage/stage_file.h"
#include "stage/stage_settings.h"

namespace neuvv::edit {

size_t node_count(const stage::StageFile& file);
// The node of this name, else of this index in decimal. Throws InputError where several bear the name, or none.
uint32_t find_node(const stage::StageFile& file, const std::string& name_or_index);
// Empty where the node has no name.
std::string name_of(const stage::StageFile& file, uint32_t node);
// What people call it: its name, or "node 3" where it has none.
std::string node_title(const stage::StageFile& file, uint32_t node);

// What a node is to those who look for it; of several kinds, the first of these.
enum class NodeKind { kPerformer, kLight, kCamera, kMesh, kGroup };
NodeKind kind_of(const stage::StageFile& file, uint32_t node);

// The nodes that hang on a node.
std::vector<uint32_t> children_of(const stage::StageFile& file, uint32_t node);
// The node and all below it, parents first.
std::vector<uint32_t> family_of(const stage::StageFile& file, uint32_t node);
// The nodes at the top of the default scene; without any scene, all nodes that hang on none. Bound by the number of
// nodes.
std::vector<uint32_t> scene_roots(const stage::StageFile& file);
// By node: whether the default scene holds it. Bound by the number of nodes.
std::vector<bool> nodes_in_scene(const stage::StageFile& file);
// Whether the first `count` nodes of two documents are the same, so that their indices mean the same nodes.
bool same_nodes(const stage::StageFile& a, const stage::StageFile& b, size_t count);

// A node's own transform, in the space of its parent, metres. Of a matrix with shear: the rotation that keeps its X
// axis and the plane of X and Y. A flat matrix has no rotation.
struct NodeTransform {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};  // X is negative where the transform mirrors
};
NodeTransform transform_of(const stage::StageFile& file, uint32_t node);
// Whether an animation moves the node itself.
bool is_animated(const stage::StageFile& file, uint32_t node);

// What the node itself says: whether those above it are shown is not asked.
bool is_visible(const stage::StageFile& file, uint32_t node);
bool is_locked(const stage::StageFile& file, uint32_t node);

// The camera on a node, nothing where it has none.
std::optional<stage::GltfCamera> camera_on(const stage::StageFile& file, uint32_t node);

// The performer on a node, in the scene or not; nothing where it has none.
std::optional<stage::PerformerSettings> performer_on(const stage::StageFile& file, uint32_t node);
// The .nvv that a performer's node plays; whether it is there is not asked. Throws InputError where the node has no
// performer.
std::filesystem::path clip_of(const stage::StageFile& file, uint32_t node);

// What the default scene says of the stage as a whole.
stage::StageSettings stage_settings_of(const stage::StageFile& file);
// Its camera path alone, nothing where it has none.
std::optional<stage::CameraPath> camera_path_of(const stage::StageFile& file);

}  // namespace neuvv::edit
