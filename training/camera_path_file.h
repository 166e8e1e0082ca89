// Camera paths as files: NeuVV's own, instant-ngp's and nerfstudio's. training/README.md says what is read from each.
#pragma once

#include <filesystem>

#include "stage/camera_path.h"

namespace neuvv::training {

// Recognises the format by its keys: `frames` (a transforms.json), `path` (instant-ngp), `camera_path` or `keyframes`
// (nerfstudio). The frames of a transforms.json without `seconds` are separate views, `views_per_s` of them a second
// (Interpolation::kCut). Throws InputError with the file and the place in its JSON.
stage::CameraPath read_camera_path(const std::filesystem::path& file, double views_per_s);

// Writes a transforms.json with `seconds`, which reads back as the same path. The file is replaced atomically.
void write_camera_path(const std::filesystem::path& file, const stage::CameraPath& path);

}  // namespace neuvv::training
