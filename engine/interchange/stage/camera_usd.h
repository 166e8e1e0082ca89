// Moving cameras in OpenUSD: UsdGeomCamera with time samples.
#pragma once

#include <filesystem>
#include <string>

#include "stage/camera_path.h"

namespace neuvv::interchange {

// Writes a .usda with one camera, and a sample for each key of the path, whose keys are images (stage::by_images). The
// world is ours, metres with +Y up. Everything of the path is kept but clip times and that it is cyclic. Written
// atomically; throws RuntimeFailure.
void write_camera_usda(const std::filesystem::path& file, const stage::CameraPath& images);

// The same as the text of a prim, for a file with several.
std::string usd_camera_prim(const std::string& name, const stage::CameraPath& images, const std::string& indent);

// The first perspective camera of a .usda as a path with a key at each of its time samples, linear in between; the
// layer's startTimeCode, or the first sample, is second 0. Throws InputError.
stage::CameraPath read_camera_usda(const std::filesystem::path& file);

}  // namespace neuvv::interchange
