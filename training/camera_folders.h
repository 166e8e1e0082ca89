// Images of a capture kept by camera: images/<camera>/<frame>.jpg or videos/<camera>.mp4, and masks alike.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "training/rig.h"

namespace neuvv::training {

// Numbers within names by their value: "f2" before "f10".
struct NaturalOrder {
    bool operator()(const std::string& a, const std::string& b) const;
};

// By frame: file name without extension; of a video the frame's number, six digits.
using Frames = std::map<std::string, ImageSource, NaturalOrder>;

// The .png, .jpg and .jpeg files of a folder (none: an empty map). Throws InputError for two of one name.
Frames images_in(const std::filesystem::path& folder);

// Of images/<camera>/, <camera>/, videos/<camera>.* and <camera>.*, the first that is there; empty: none. Sets `fps`
// where it is a video.
Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera, double& fps);

// The first of `names` that is a folder of `folder`; empty: none.
std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names);

// A mask for each of the frames, from masks/<camera>/ by name, or from a video masks/<camera>.* by order. Throws
// InputError where one is missing.
Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames);

struct CameraFrames {
    RigCamera camera;
    std::string place;  // of the camera in rig.file, for errors
    size_t group = 0;   // cameras of one group are held out together
    Frames frames, masks;
};

// Throws InputError where no two of several cameras share a frame's name.
void expect_common_frames(const Rig& rig, const std::vector<CameraFrames>& cameras);

// The cameras of a split with their shots: every 8th group is held out, beginning with the first. Frames of one name
// are one time; the i-th of all cameras' N times is the time i/(N−1). Throws InputError where there is but one
// group.
void add_cameras(Rig& rig, const std::vector<CameraFrames>& cameras, Split split);

}  // namespace neuvv::training
