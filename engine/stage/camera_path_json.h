// A camera path as a stage keeps it: `cameraPath` of NEUVV_stage.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "stage/camera_path.h"

namespace neuvv::stage {

constexpr const char* kInterpolationNames[] = {"smooth", "linear", "cut"};  // by Interpolation
constexpr size_t kMaxPathKeys = 65536;
constexpr double kMinPathAngle_rad = 1e-3, kMaxPathAngle_rad = 3.14;

// `place` is the path's JSON place. Throws InputError for what CameraPath does not promise.
CameraPath camera_path_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Of a key: time, position, rotation, vertical angle; what else it has is no stage's.
nlohmann::ordered_json json_of(const CameraPathKey& key);
nlohmann::ordered_json json_of(const CameraPath& path);

}  // namespace neuvv::stage
