// A glTF document in one file: a .glb that holds the bytes of the files beside it.
#pragma once

#include <filesystem>

#include "stage/file/stage_file.h"
#include "stage/gltf/glb_writer.h"

namespace neuvv::stage {

// The document with all of its buffers as one, and with its .png and .jpeg images in that. All other members keep their
// indices. Its relative URIs are for the folder of `output`, where it is to be written: those of clips still name
// their files. Throws InputError as load_gltf and moved_to do.
GlbWriter embedded(StageFile file, const std::filesystem::path& output);

}  // namespace neuvv::stage
