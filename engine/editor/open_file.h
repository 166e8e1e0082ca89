// Opens the file or folder that a user names as a document: a stage, a clip, or a folder of clips.
#pragma once

#include <filesystem>

#include "edit/edited_stage.h"

namespace neuvv::editor {

// Whether the path ends in .gltf or .glb, in upper or lower case.
bool has_stage_ending(const std::filesystem::path& path);

// What stands around a clip that is opened.
enum class AroundClip { kNothing, kLitFloor };

// Opens a stage as it is. A clip (.nvv, .nvs, .npz), the newest .nvv of a folder, or the stream at an address is opened
// as the only performer of a new stage, which is not on the disk yet: beside the clip, of an address in the working
// folder. Throws InputError.
edit::Document open_document(const std::filesystem::path& path, AroundClip around = AroundClip::kNothing);

// The path that the stage of open_document(path) has. Throws InputError.
std::filesystem::path stage_of_file(const std::filesystem::path& path);

}  // namespace neuvv::editor
