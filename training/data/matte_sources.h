// What a data set's files already say of which pixels show the performer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// The folder of the mattes that `neuvv matte` or a person put beside a data set.
std::filesystem::path mattes_folder(const Rig& rig);

// The file of an image's matte in a folder of mattes, NAME.png, whether it is there or not. Where it is not, but
// CAMERA_FILE.png is, that: names of images once began with their cameras' in any case, "cam0_cam0_0001" where it is
// "cam0_0001" now.
std::filesystem::path matte_file(const std::filesystem::path& folder, const Rig& rig, const Shot& shot);

// mattes/, masks that mean mattes, or an alpha of the images, of which one image of each of a few cameras is read. In
// the order in which they count: each overrules those behind it. Empty where there is none.
std::vector<std::string> matte_sources(const std::vector<Rig>& splits);

}  // namespace neuvv::training
