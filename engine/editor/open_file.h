// Opens the file or folder that a user names as a document: a stage, a clip, or a folder of clips.
#pragma once

#include <filesystem>

#include "edit/edited_stage.h"

namespace neuvv::editor {

// Whether the path ends in .gltf or .glb, in upper or lower case.
bool has_stage_ending(const std::filesystem::path& path);

// Opens a stage as it is. A clip (.nvv, .npz), or the newest .nvv of a folder, is opened as the only performer of a new
// stage beside it, which is not on the disk yet. Throws InputError.
edit::Document open_document(const std::filesystem::path& path);

// The path that the stage of open_document(path) has. Throws InputError.
std::filesystem::path stage_of_file(const std::filesystem::path& path);

}  // namespace neuvv::editor
