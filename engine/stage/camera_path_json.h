// Reads and writes a camera path as JSON: the member `cameraPath` of NEUVV_stage (README.md).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "stage/camera_path.h"

namespace neuvv::stage {

constexpr const char* kInterpolationNames[] = {"smooth", "linear", "cut"};  // indexed by Interpolation
constexpr double kMinPathAngle_rad = 1e-3, kMaxPathAngle_rad = 3.14;

// `place` is the path's location in the JSON, for error messages. Throws InputError where a number is out of range or
// the keys break the rules of CameraPath.
CameraPath camera_path_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Writes a key's time, position, rotation and vertical angle of view; a stage does not store its other members.
nlohmann::ordered_json json_of(const CameraPathKey& key);
nlohmann::ordered_json json_of(const CameraPath& path);

}  // namespace neuvv::stage
