// Camera paths as files: ours, instant-ngp's and nerfstudio's. What is taken from each: training/README.md.
#pragma once

#include <filesystem>

#include "stage/camera_path.h"

namespace neuvv::training {

// Recognises the format by its keys: `frames` (a transforms.json), `path` (instant-ngp), `camera_path` or `keyframes`
// (nerfstudio). The frames of a transforms.json without `seconds` are views of their own, shown one after the other
// `views_per_s` a second (Interpolation::kCut). Throws InputError naming the file and the JSON place.
stage::CameraPath read_camera_path(const std::filesystem::path& file, double views_per_s);

// A transforms.json with `seconds`, which reads back as the same path; atomically.
void write_camera_path(const std::filesystem::path& file, const stage::CameraPath& path);

}  // namespace neuvv::training
