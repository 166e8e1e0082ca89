// Moving cameras in glTF: a camera on a node with an animation.
#pragma once

#include <filesystem>

#include "stage/camera_path.h"

namespace neuvv::interchange {

// Writes a .glb with one camera, and a key of its animation for each key of the path, whose keys are images
// (stage::by_images). glTF's cameras have one angle of view, that of the first key. stage::path_of_camera
// reads the file back. Written atomically; throws InputError and RuntimeFailure.
void write_camera_glb(const std::filesystem::path& file, const stage::CameraPath& images);

}  // namespace neuvv::interchange
