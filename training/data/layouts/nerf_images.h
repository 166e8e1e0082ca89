// The images of frames of transforms files: an image, or all of a folder or a video.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "interchange/camera/transforms.h"
#include "training/data/layouts/rig/camera_folders.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// A frame of the file, or one image of the folder or of the video that it names: its file_path then ends in the name of
// the image, or in the number of the video's frame.
struct ImageFrame {
    interchange::TransformsFrame frame;
    ImageSource image, mask;
};

// The images of a folder or a video, and their masks.
struct Sequence {
    Frames frames, masks;
};
using Sequences = std::map<std::string, Sequence>;  // by file_path

// Those that frames of all splits name. Frames of videos are named by their times.
Sequences find_sequences(Rig& rig, const std::vector<interchange::TransformsFrame>& first,
                         const std::vector<interchange::TransformsFrame>& others);
// Frames without their image go to `others`, with a remark. Throws InputError where these are more than half.
std::vector<ImageFrame> image_frames(Rig& rig, const std::vector<interchange::TransformsFrame>& frames,
                                     const Sequences& sequences, std::vector<interchange::TransformsFrame>& others);
// The frames of the other splits, with their sequences spread out. Their images need not exist.
std::vector<interchange::TransformsFrame> spread_frames(const Rig& rig,
                                                        const std::vector<interchange::TransformsFrame>& frames,
                                                        const Sequences& sequences);

// The image of this path. Throws InputError with the place in the file where there is none.
std::filesystem::path find_image(const Rig& rig, const std::string& path, const std::string& place);
// Notes in rig.remarks which images were read where several endings fit.
void note_endings(Rig& rig, const std::vector<interchange::TransformsFrame>& frames);

}  // namespace neuvv::training
