// The images that a brush may project: the PNG files beside a stage.
#pragma once

#include <filesystem>

namespace neuvv::headset {

// The image of the folder that comes after this one in the order of names, and after the last one the first. Empty
// where the folder has none or cannot be read.
std::filesystem::path next_image(const std::filesystem::path& folder, const std::filesystem::path& after);

}  // namespace neuvv::headset
