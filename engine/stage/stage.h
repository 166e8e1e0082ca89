// A stage: a glTF 2.0 scene with performers on its nodes, as plain, validated data. evaluated_stage.h evaluates it at a
// time.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/file_stamp.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/performer_settings.h"
#include "stage/stage_settings.h"
#include "stage/time_map.h"
#include "voctree/files/clip_index.h"

namespace neuvv::stage {

// A volumetric video. A stage has each file once, however many performers play it.
struct StageClip {
    std::filesystem::path path;  // absolute
    uint32_t frames = 1;
    double fps = 25;
    glm::dvec3 box_min{0}, box_size{1};  // performer's space, metres
    std::shared_ptr<const voctree::ClipIndex> index{};
};

// A node of the default scene that has NEUVV_performer.
struct StagePerformer {
    uint32_t node = 0;  // index into GltfScene::nodes
    std::string name;   // node_title
    uint32_t clip = 0;  // index into Stage::clips
    PerformerSettings settings;
    std::filesystem::path skeleton, sound;  // absolute, or an address of a sound; empty where the file names none
    Timeline timeline;
};

struct Stage {
    StageFile file;
    GltfScene scene;
    // The files outside of the stage's own from which buffers and images were read.
    std::vector<std::pair<std::filesystem::path, FileStamp>> read_files;
    std::vector<StageClip> clips;  // one for each file
    std::vector<StagePerformer> performers;
    StageSettings settings;
    // From the settings, or the defaults that StageSettings names where these are not given.
    double duration_s = 0, fps = 25;
    glm::dvec3 ambient{0};
};

// Any glTF scene is a stage. Throws InputError for what load_gltf refuses, for invalid members of the NEUVV extensions,
// for a .nvv that is missing or damaged (only its header is read), for performers whose transform cannot be inverted,
// and for nodes farther than 1e9 m from the origin.
Stage load_stage(const std::filesystem::path& path);
// The same for a file with unsaved edits. What did not change since `before`, a stage of an earlier state of the
// document, is shared with it: where only nodes, scenes, cameras and lights changed, no buffer or image is read.
Stage make_stage(StageFile file, const Stage* before = nullptr);

// Throws InputError where the file must not be saved: makes all checks of make_stage except that a .nvv may be missing.
void expect_sound_document(const StageFile& file, const Stage* before = nullptr);

// The name by which a node is shown: its own, or "node 3" where it has none.
std::string node_title(const GltfScene& scene, uint32_t node);

// Whether the node's position is finite and each of its coordinates within 1e9 m of the origin.
bool is_on_stage(const glm::dmat4& world_from_node);
// Whether `world_from_node` can be a performer's: on the stage, with scales of 1e-6 to 1e6, and far enough from flat to
// be inverted in single precision.
bool is_valid_transform(const glm::dmat4& world_from_node);

}  // namespace neuvv::stage
