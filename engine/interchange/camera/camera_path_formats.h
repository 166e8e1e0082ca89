// Internal to this module: camera paths of instant-ngp and nerfstudio as JSON, and what reading them shares.
#pragma once

#include "interchange/camera/transforms.h"
#include "stage/camera_path.h"

namespace neuvv::interchange {

// All of them throw InputError with the place in the JSON.
stage::CameraPath ngp_path(const JsonNode& root);
stage::CameraPath nerfstudio_path(const JsonNode& root);

void set_pose(stage::CameraPathKey& key, const glm::dmat4& world_from_camera);
// An angle of view, from degrees to radians.
double path_degrees(const JsonNode& node);
// Checks what CameraPath promises about the times of its keys; `keys` is their list.
void expect_path_times(const stage::CameraPath& path, const JsonNode& keys);

}  // namespace neuvv::interchange
