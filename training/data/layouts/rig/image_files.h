// The files of images, masks and videos, and where a data set has those of a camera.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// Orders names so that numbers in them count by their value: "f2" comes before "f10".
struct NaturalOrder {
    bool operator()(const std::string& a, const std::string& b) const;
};

// Images by the name of their frame: the file name without extension, or the number of a video's frame in six digits.
using Frames = std::map<std::string, ImageSource, NaturalOrder>;

// The .png, .jpg and .jpeg files of a folder, hidden ones left out; empty where it has none. Throws InputError where
// two have one name.
Frames images_in(const std::filesystem::path& folder);

bool is_video(const std::filesystem::path& path);  // by its extension
// All frames of a video.
Frames frames_of_video(const std::filesystem::path& path);

// The name of a camera's frame where it has only one image.
constexpr const char* kOnlyFrame = "0";

// The one image <camera>.* of the folder, as kOnlyFrame; empty where there is none.
Frames still_in(const std::filesystem::path& folder, const std::string& camera);
// That of images/, else of the folder itself.
Frames still_of_camera(const std::filesystem::path& folder, const std::string& camera);

// The folders and the videos in which a camera may have its images and has some: images/<camera>/ (or
// images_2/<camera>/ …: candidates.h), the like in folders of other names (image_folders in image_files.cpp),
// <camera>/, videos/<camera>.* and its like, and <camera>.*. A video may have a longer name that ends in _<camera>, as
// Qualisys gives it.
std::vector<std::filesystem::path> places_of_camera(const std::filesystem::path& folder, const std::string& camera);

// The frames in the first of these places; empty where there is none. Where the names of all images of the camera begin
// with its own, frames are named without it: "00_03_0017" of the camera 00_03 is frame "0017", as is "Cam001_rgb0017"
// of Cam001. Throws InputError where the first place is two videos.
Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera);

// The image <name>.*, else the video <name>.* or *_<name>.* at its first frame; an empty path where there is neither.
ImageSource image_or_video(const std::filesystem::path& folder, const std::string& name);

// The names of cameras by those of the folders of images in images/ or its like, or else of the videos in videos/ or
// its like, in natural order. `places`: where each of them has its images, as "images/left/" or "videos/left.*".
struct NamesOfImages {
    std::string folder;  // "images/"
    std::vector<std::string> names, places;
};
NamesOfImages names_of_images(const std::filesystem::path& folder);

// The path of the first of `names` that is a folder inside `folder`; empty where none is.
std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names);

// Whether find_images (camera_folders.h) finds images of the camera, whose name must be inside the data set's folder
// (expect_inside). No video is opened.
bool has_images(const std::filesystem::path& folder, const std::string& camera);

// A mask for each of the frames: from masks/<camera>/, matched by the name of the frame or by its file's ("0.jpg.png",
// as COLMAP names masks), or from a video masks/<camera>.*, matched by order. Throws InputError where a mask is
// missing.
Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames);

// The folders of masks in a data set, of which the first counts: masks, mask, mask_cihp (ZJU-MoCap), bgmtv2, msk
// (EasyVolcap).
std::vector<std::filesystem::path> masks_folders(const std::filesystem::path& folder);
std::filesystem::path masks_folder(const std::filesystem::path& folder);  // that one; empty where there is none

// The name without the extension of an image or a video, which some programs leave in the names of their cameras.
std::string without_extension(const std::string& name);

}  // namespace neuvv::training
