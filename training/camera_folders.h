// Images of a capture that are stored by camera: images/<camera>/<frame>.jpg or videos/<camera>.mp4, and masks alike.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "training/rig.h"

namespace neuvv::training {

// Orders names so that numbers in them count by their value: "f2" comes before "f10".
struct NaturalOrder {
    bool operator()(const std::string& a, const std::string& b) const;
};

// Images by the name of their frame: the file name without extension, or the number of a video's frame in six digits.
using Frames = std::map<std::string, ImageSource, NaturalOrder>;

// The .png, .jpg and .jpeg files of a folder; empty where it has none. Throws InputError where two have one name.
Frames images_in(const std::filesystem::path& folder);

// The frames in the first of images/<camera>/, <camera>/, videos/<camera>.* and <camera>.* that exists; empty where
// none does. Sets `fps` where the frames are those of a video.
Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera, double& fps);

// The path of the first of `names` that is a folder inside `folder`; empty where none is.
std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names);

// A mask for each of the frames: from masks/<camera>/, matched by name, or from a video masks/<camera>.*, matched by
// order. Throws InputError where a mask is missing.
Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames);

struct CameraFrames {
    RigCamera camera;
    std::string place;  // where in rig.file the camera stands, for errors
    size_t group = 0;   // cameras of one group are held out together
    Frames frames, masks;
};

// Throws InputError where there are several cameras and no two of them have a frame of the same name.
void expect_common_frames(const Rig& rig, const std::vector<CameraFrames>& cameras);

// Adds the cameras of a split with their shots: every 8th group is held out, beginning with the first. Frames with the
// same name have the same time; the i-th of N names has the time i/(N−1). Throws InputError where there is only one
// group.
void add_cameras(Rig& rig, const std::vector<CameraFrames>& cameras, Split split);

}  // namespace neuvv::training
