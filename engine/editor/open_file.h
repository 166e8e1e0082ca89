// Opens what a user names, as a document: a stage, a clip, or a folder of clips.
#pragma once

#include <filesystem>

#include "edit/edited_stage.h"

namespace neuvv::editor {

// Whether it is named like a stage: .gltf or .glb, in letters of either case.
bool has_stage_ending(const std::filesystem::path& path);

// A stage as it is; a clip (.nvv, .npz), or the newest .nvv in a folder, alone on a stage of its own beside it, not on
// the disk yet. Throws InputError.
edit::Document open_document(const std::filesystem::path& path);

// The path of the stage that open_document gives.
std::filesystem::path stage_of_file(const std::filesystem::path& path);

}  // namespace neuvv::editor
