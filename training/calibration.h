// What readers of calibrations share: poses in OpenCV's convention, and checks of lenses, poses and names.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "training/rig.h"

namespace neuvv::training {

constexpr uint32_t kHoldOut = 8;  // where files name no test cameras, every 8th is held out, beginning with the first

// The camera's pose, with OpenGL axes, where x_camera = rotation · x_world + translation in OpenCV axes (x right,
// y down, z forward).
glm::dmat4 world_from_opencv(const glm::dmat3& rotation, const glm::dvec3& translation);

// Throws InputError(file, place, …) for a lens or a camera position that cannot be right: numbers that are not finite
// or absurdly large, a focal length that is not positive, a width of 0 beside a height or the reverse.
void expect_sound(const RigCamera& camera, const std::string& file, const std::string& place);

// Throws InputError for a name that leads out of the data set's folder, is empty, or cannot be a file name.
void expect_inside(const std::string& name, const std::string& file, const std::string& place);

}  // namespace neuvv::training
