// `neuvv dataset --as`: a data set written as the files of another layout.
#pragma once

#include <filesystem>
#include <string>

namespace neuvv::tools {

struct WrittenPart {
    std::string frames;  // parse_frame_range; empty: all
    uint32_t reduction = 1;
};

// Writes the data set as transforms files and images into a folder, whole or not at all, and says what it wrote. Its
// training images are checked against each other as `train` does (camera_check.h).
void write_as_transforms(const std::filesystem::path& dataset, const std::string& format, const std::string& holdout,
                         const std::filesystem::path& output, const WrittenPart& part);

}  // namespace neuvv::tools
