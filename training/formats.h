// The layouts of captures that NeuVV reads, recognised by their files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/rig.h"

namespace neuvv::training {

constexpr char kAnyFormat[] = "auto";

// For --format: kAnyFormat, then the layouts.
std::vector<std::string> format_names();

// The cameras and images of a split, in order of the shots' first use, checked: there is a shot, shots have distinct
// names, images and times of their camera, and times in [0,1]. `format` is one of format_names(); kAnyFormat takes
// the first layout whose files are there. Throws InputError.
Rig read_rig(const std::filesystem::path& folder, Split split, const std::string& format = kAnyFormat);

}  // namespace neuvv::training
