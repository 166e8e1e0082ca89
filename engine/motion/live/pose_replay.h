// A recorded motion as a source of poses.
#pragma once

#include <filesystem>
#include <memory>

#include "motion/live/pose_source.h"

namespace neuvv::motion {

// Reads the whole file: lines of JSON where its name ends in .jsonl, else what read_skeleton reads. Lines that are no
// poses, or whose time is not after the last one's, are left out. Throws InputError where no pose is left.
std::unique_ptr<PoseSource> replay_poses(const std::filesystem::path& file);

}  // namespace neuvv::motion
