// A stage: a glTF 2.0 scene with performers on its nodes, as plain, validated data. stage_instant.h evaluates it.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/file_stamp.h"
#include "stage/gltf_scene.h"
#include "stage/performer_settings.h"
#include "stage/stage_file.h"
#include "stage/stage_settings.h"
#include "stage/time_map.h"

namespace neuvv::stage {

// A volumetric video, once, however many performers play it.
struct StageClip {
    std::filesystem::path path;  // absolute
    uint32_t frames = 1;
    double fps = 25;
    glm::dvec3 box_min{0}, box_size{1};  // performer's space, metres
};

// A node of the default scene that has NEUVV_performer.
struct StagePerformer {
    uint32_t node = 0;  // index into GltfScene::nodes
    std::string name;   // the node's, or "node 3"
    uint32_t clip = 0;  // index into Stage::clips
    PerformerSettings settings;
    Timeline timeline;
};

struct Stage {
    StageFile file;
    GltfScene scene;
    // Beside the stage, that buffers and images were read from.
    std::vector<std::pair<std::filesystem::path, FileStamp>> read_files;
    std::vector<StageClip> clips;  // distinct files
    std::vector<StagePerformer> performers;
    StageSettings settings;
    // Of the settings, or what they leave to the stage.
    double duration_s = 0, fps = 25;
    glm::dvec3 ambient{0};
};

// Any glTF scene is a stage. Throws InputError for what load_gltf refuses, for wrong members of our extensions, for a
// .nvv that is missing or damaged (its header is read, no more), and for performers whose transform cannot be inverted.
Stage load_stage(const std::filesystem::path& path);
// The same of a file with edits that are not saved. Of `before`, a stage of an earlier state of the document, it shares
// what did not change: where only nodes, scenes, cameras and lights did, buffers are not even looked at.
Stage make_stage(StageFile file, const Stage* before = nullptr);

// Everything that make_stage checks, but a .nvv may be missing: whether a file may be saved.
void expect_sound_document(const StageFile& file, const Stage* before = nullptr);

// What people call a node: its name, or "node 3" where it has none.
std::string node_title(const GltfScene& scene, uint32_t node);

// Whether the node stands at a finite place, within 1e9 m.
bool is_on_stage(const glm::dmat4& world_from_node);
// Whether `world_from_node` can be a performer's: finite, and far enough from flat to be inverted in single precision.
bool is_placeable(const glm::dmat4& world_from_node);

}  // namespace neuvv::stage
