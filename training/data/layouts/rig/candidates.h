// Which of several files or folders of a data set counts, and what is said of the others: a remark of the rig. Hidden
// files (macOS leaves ._NAME beside NAME on other file systems) are no candidates anywhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace neuvv::training {

bool is_hidden(const std::filesystem::path& path);

// What a folder holds, hidden files left out, in order of the names; empty where it cannot be read.
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

// A name as files of Windows write it: with slashes for backslashes. Of a path with a drive, which names a place on
// another machine, the file's name remains.
std::string portable_name(std::string name);

// One of several candidates. The remark names it and the others; it is empty where there were no others.
struct Choice {
    std::filesystem::path path;
    std::string remark;
};

// The file that was written last, as Pose2Sim takes its calibrations; of files of one date the last by name. An empty
// path where there are none.
Choice newest_of(std::vector<std::filesystem::path> files);

// The folder, and those in it whose name contains "calib", as Pose2Sim looks for them.
std::vector<std::filesystem::path> calibration_folders(const std::filesystem::path& folder);

// Where a trial of Pose2Sim, a folder with videos/ or pose/, may have the calibration of its session: the folders above
// it, the nearest first, each followed by those in it whose name contains "calib". Empty for other folders.
std::vector<std::vector<std::filesystem::path>> session_folders(const std::filesystem::path& folder);

// The folder of a capture's images: images, or else the first of images_2, images_4 …, which other programs make of
// smaller copies.
Choice images_folder(const std::filesystem::path& folder);

// The first four names, and how many more there are: "B, C, D, E and 3 more".
std::string first_names(const std::vector<std::string>& names);

// What a folder holds, for errors: "0001.tif, masks/ and 3 more"; "nothing" where it holds nothing, or is not there.
std::string entries_text(const std::filesystem::path& folder);

// "A was read", and what else was there: "A was read, not B, C and 3 more".
std::string choice_remark(const std::string& chosen, const std::vector<std::string>& others);

}  // namespace neuvv::training
