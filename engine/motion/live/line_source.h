// Poses that another program writes, as lines of JSON.
#pragma once

#include <memory>
#include <string>

#include "motion/live/pose_source.h"

namespace neuvv::motion {

// Reads a descriptor, which stays open as long as the source lives.
std::unique_ptr<PoseSource> read_lines_of_poses(int descriptor, const std::string& name);

}  // namespace neuvv::motion
