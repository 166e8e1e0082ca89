// Images of a capture that are stored by camera: images/<camera>/<frame>.jpg or videos/<camera>.mp4, and masks alike.
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

// The frames in the first of images/<camera>/ (or images_2/<camera>/ …: candidates.h), <camera>/, videos/<camera>.* and
// <camera>.* that exists; empty where none does. A video may have a longer name that ends in _<camera>, as Qualisys
// gives it. Throws InputError where two videos have such names.
Frames frames_of_camera(const std::filesystem::path& folder, const std::string& camera);

// The image <name>.*, else the video <name>.* or *_<name>.* at its first frame; an empty path where there is neither.
ImageSource image_or_video(const std::filesystem::path& folder, const std::string& name);

// The names of a folder's videos, without extension, in natural order.
std::vector<std::string> videos_in(const std::filesystem::path& folder);

// The path of the first of `names` that is a folder inside `folder`; empty where none is.
std::filesystem::path first_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names);

// Whether find_images finds images of the camera, whose name must be inside the data set's folder (expect_inside). No
// video is opened.
bool has_images(const std::filesystem::path& folder, const std::string& camera);

// A mask for each of the frames: from masks/<camera>/, matched by the frame's name or by its file's ("0.jpg.png", as
// COLMAP names masks), or from a video masks/<camera>.*, matched by order. Throws InputError where a mask is missing.
Frames masks_of_camera(const std::filesystem::path& masks, const std::string& camera, const Frames& frames);

// The folder of the masks of a data set: masks, mask or mask_cihp; empty where there is none.
std::filesystem::path masks_folder(const std::filesystem::path& folder);

// The name without the extension of an image or a video, which some programs leave in the names of their cameras.
std::string without_extension(const std::string& name);

// A camera as a calibration describes it, before its images are looked for. Its name is that of its images.
struct CalibratedCamera {
    RigCamera camera;
    std::string place;  // where in rig.file the camera stands, for errors
};

// The name of a camera's frame where it has only one image.
constexpr const char* kOnlyFrame = "0";

// A remark about captures of one camera that moved.
constexpr const char* kOneMoment =
    "one camera that moved, so all images show one frame: what moved meanwhile cannot be trained; a performer in "
    "motion "
    "needs several cameras at each moment";

struct CameraFrames {
    RigCamera camera;
    std::string place;  // where in rig.file the camera stands, for errors
    size_t group = 0;   // cameras of one group are held out together
    Frames frames, masks;
};

// Names the frames of videos, and their masks, by the moments that they show (clip_times.h) instead of by their numbers
// in the video, and leaves out those at no moment of the clip. Sets rig.fps to the clip's rate and adds remarks.
// Cameras without videos stay as they are.
void name_by_time(Rig& rig, std::vector<CameraFrames>& cameras);

// The frames and the masks of each camera: those of frames_of_camera, by name_by_time, else one image images/<camera>.*
// or <camera>.*, whose mask is masks/<camera>.*. Every camera is a group of its own. Cameras without images are left
// out; rig.remarks says how many. Where images are scaled copies of those that the calibration is for, lenses are
// scaled, too. Throws InputError for names that are no names within the data set's folder, or given twice, and where no
// camera has images.
std::vector<CameraFrames> find_images(Rig& rig, const std::vector<CalibratedCamera>& cameras);

// Adds remarks where cameras have images in several places, of which the first of frames_of_camera was read.
void note_choices(Rig& rig, const std::vector<CameraFrames>& cameras);
// Adds a remark where there are several folders of masks, of which the first was read.
void note_mask_folders(Rig& rig);

// Throws InputError where there are several cameras and no two of them have a frame of the same name.
void expect_common_frames(const Rig& rig, const std::vector<CameraFrames>& cameras);

// Adds the cameras of a split with their shots: every 8th group is held out, beginning with the first. Frames with the
// same name have the same time; the i-th of N names has the time i/(N−1). Throws InputError where there is only one
// group, but for Split::kAll.
void add_cameras(Rig& rig, const std::vector<CameraFrames>& cameras, Split split);

}  // namespace neuvv::training
