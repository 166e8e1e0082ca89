// The layouts of data sets that NeuVV reads, recognised by their files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

constexpr char kAnyFormat[] = "auto";

// What a format may be called: kAnyFormat, then the names of the layouts.
std::vector<std::string> format_names();

// The cameras and shots of a split; cameras without shots are left out. What it returns is checked: there is a shot, no
// two shots have the same name, the same image, or the same camera and time, and times lie in [0,1]. `format` is one of
// format_names(); kAnyFormat takes the first layout whose files exist. Throws InputError.
// `holdout` says which cameras are held out (holdout.h); where it is empty, the layout does.
Rig read_rig(const std::filesystem::path& folder, Split split, const std::string& format = kAnyFormat,
             const std::string& holdout = "");

// Whether read_rig gives images for Split::kVal. Throws InputError where the layout's file cannot be read.
bool has_validation(const std::filesystem::path& folder, const std::string& format = kAnyFormat);
// The cameras and shots of all splits, for points that were found in the images: these may have another shape than the
// calibration says (Rig::misfit), which read_rig refuses.
Rig read_rig_of_points(const std::filesystem::path& folder);

// Removes the cameras of which no shot is in the rig.
void drop_cameras_without_shots(Rig& rig);

}  // namespace neuvv::training
