// What the document of a stage contains, as plain values: the reading side of operations.h.
//
// Programs that show or edit a stage call these functions and read no JSON. Each function reads the document itself, so
// that an edit is visible in the next frame, before a Stage has been made of the document. Lights are in
// light_values.h, performers on a time line in tracks.h, layers of paint in paint_layers.h.
//
// The functions expect a document with a sound structure, as expect_sound_document checks and as every operation leaves
// it: what glTF and our extensions define has its type, indices name existing elements, and no node is below itself.
// Whatever is optional may be missing; the result then is the default of glTF or of our extension. What only other
// programs define may be anything. For a node that does not exist, functions that return an optional return nullopt;
// all others throw InputError. Numbers are returned as they were written: where a number of our extensions is out of
// its range, performer_on, stage_settings_of and camera_path_of throw InputError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stage/camera_path.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/performer_settings.h"
#include "stage/stage_settings.h"

namespace neuvv::edit {

size_t node_count(const stage::StageFile& file);
// The node with this name, else with this index in decimal. Throws InputError where several nodes have the name, or
// none has.
uint32_t find_node(const stage::StageFile& file, const std::string& name_or_index);
// The name of a node; empty where it has none.
std::string name_of(const stage::StageFile& file, uint32_t node);
// The name that people see: the node's name, or "node 3" where it has none.
std::string node_title(const stage::StageFile& file, uint32_t node);

// The kind of a node; where it is several of these, the first.
enum class NodeKind { kPerformer, kLight, kCamera, kMesh, kGroup };
NodeKind kind_of(const stage::StageFile& file, uint32_t node);

// The children of a node.
std::vector<uint32_t> children_of(const stage::StageFile& file, uint32_t node);
// The node and all nodes below it, parents first.
std::vector<uint32_t> family_of(const stage::StageFile& file, uint32_t node);
// The nodes at the top of the default scene; without any scene, all nodes that have no parent. Takes time in proportion
// to the number of nodes.
std::vector<uint32_t> scene_roots(const stage::StageFile& file);
// Per node: whether the default scene contains it. Takes time in proportion to the number of nodes.
std::vector<bool> nodes_in_scene(const stage::StageFile& file);
// Whether the first `count` nodes of two documents are the same, so that their indices mean the same nodes.
bool same_nodes(const stage::StageFile& a, const stage::StageFile& b, size_t count);

// A node's own transform in the space of its parent, metres. Of a matrix with shear, `rotation` is the one that keeps
// its X axis and the plane of X and Y. For a flat matrix, `rotation` is the identity.
struct NodeTransform {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};  // X is negative where the transform mirrors
};
NodeTransform transform_of(const stage::StageFile& file, uint32_t node);
// Whether an animation moves the node itself.
bool is_animated(const stage::StageFile& file, uint32_t node);

// Whether the node itself is visible, regardless of the nodes above it; and whether it is locked.
bool is_visible(const stage::StageFile& file, uint32_t node);
bool is_locked(const stage::StageFile& file, uint32_t node);
bool has_sound(const stage::StageFile& file, uint32_t node);  // a performer that has one

// The camera on a node; nullopt where it has none.
std::optional<stage::GltfCamera> camera_on(const stage::StageFile& file, uint32_t node);

// The performer on a node, whether the node is in the scene or not; nullopt where it has none.
std::optional<stage::PerformerSettings> performer_on(const stage::StageFile& file, uint32_t node);
// The path of the .nvv that a performer plays; the file may be missing. Throws InputError where the node has no
// performer.
std::filesystem::path clip_of(const stage::StageFile& file, uint32_t node);
// Those of the performers in the default scene, each once, in the order of their nodes.
std::vector<std::filesystem::path> clips_of(const stage::StageFile& file);

// The settings of the stage as a whole, from the default scene.
stage::StageSettings stage_settings_of(const stage::StageFile& file);
// Only the stage's camera path; nullopt where it has none.
std::optional<stage::CameraPath> camera_path_of(const stage::StageFile& file);

}  // namespace neuvv::edit
