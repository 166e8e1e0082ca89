// Images of a capture that are stored by camera: images/<camera>/<frame>.jpg or videos/<camera>.mp4, and masks alike.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/data/layouts/rig/image_files.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// A camera as a calibration describes it, before its images are looked for. Its name is that of its images.
struct CalibratedCamera {
    RigCamera camera;
    std::string place;  // where in rig.file the camera stands, for errors
};

// A remark about captures of one camera that moved.
constexpr const char* kOneMoment =
    "one camera that moved, so all images show one frame: what moved meanwhile cannot be trained; a performer in "
    "motion needs several cameras at each moment";

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

// Where no camera has images of its name, as those that are called after a serial number, names them after the folders
// of images or the videos that there are, in their order, and says so. Throws InputError for names that are no names
// within the data set's folder, and where there are not as many cameras as folders or videos.
void pair_by_order(Rig& rig, std::vector<CalibratedCamera>& cameras);

// The frames and the masks of each camera, after pair_by_order: those of frames_of_camera, by name_by_time, else one
// image images/<camera>.* or <camera>.*, whose mask is masks/<camera>.*. Every camera is a group of its own. Cameras
// without images are left out; rig.remarks says how many. Where images are scaled copies of those that the calibration
// is for, lenses are scaled, too. Throws InputError for names that are no names within the data set's folder, or given
// twice, and where no camera has images.
std::vector<CameraFrames> find_images(Rig& rig, std::vector<CalibratedCamera> cameras);

// An image that a file lists and that is not there.
struct MissingImage {
    std::string place;
    std::filesystem::path path;
};
// Adds a remark that they are left out. Throws InputError where they are more than half of those that are listed.
void leave_out(Rig& rig, const std::vector<MissingImage>& missing, size_t listed);

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
