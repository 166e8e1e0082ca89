// What can be opened in the viewer, as a document.
#pragma once

#include <filesystem>

#include "edit/edited_stage.h"

namespace neuvv::viewer {

// A stage as it is; a clip (.nvv, .npz), or the newest .nvv in a folder, alone on a stage of its own beside it, not on
// the disk yet. Throws InputError.
edit::Document open_document(const std::filesystem::path& path);

// The path of the stage that open_document gives.
std::filesystem::path stage_of_file(const std::filesystem::path& path);

}  // namespace neuvv::viewer
