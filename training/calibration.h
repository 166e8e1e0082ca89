// What calibrations of any layout share: OpenCV's poses turned into ours, and the numbers that no lens has.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "training/rig.h"

namespace neuvv::training {

constexpr uint32_t kHoldOut = 8;  // where the files name no test cameras: the first, the 9th, … are held out

// From x_camera = rotation · x_world + translation in OpenCV axes (x right, y down, z forward).
glm::dmat4 world_from_opencv(const glm::dmat3& rotation, const glm::dvec3& translation);

// Throws InputError(file, place, …) for a lens or a place in the world that cannot be: not finite, no focal length, a
// size of 0 where another is given, or out of all proportion.
void expect_sound(const RigCamera& camera, const std::string& file, const std::string& place);

// Throws InputError for a name that would lead out of the data set's folder, or that is none.
void expect_inside(const std::string& name, const std::string& file, const std::string& place);

}  // namespace neuvv::training
