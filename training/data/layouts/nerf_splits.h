// Which frames of transforms files are of a split, and of which camera.
#pragma once

#include <filesystem>
#include <vector>

#include "interchange/camera/transforms.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// The frames of a split, and the file that has them.
struct SplitFrames {
    std::filesystem::path file;
    interchange::Transforms transforms;
    std::vector<interchange::TransformsFrame> other_frames;  // of the other splits
};

// Of transforms_train.json and the like, or of transforms.json. Throws InputError.
SplitFrames read_split(const std::filesystem::path& folder, Split split);

// Whether there are images for the validation: transforms_val.json, or val_filenames in transforms.json.
bool has_nerf_validation(const std::filesystem::path& folder);

// Whether the folder has a file of one split, such as transforms_train.json, or whether `file` is one of them.
bool has_split_files(const std::filesystem::path& folder);
bool is_split_file(const std::filesystem::path& folder, const std::filesystem::path& file);

// The number of each frame's camera, in order of first use. Frames are of one camera where pose and intrinsics are
// equal.
std::vector<uint32_t> number_cameras(const std::vector<interchange::TransformsFrame>& frames);

// Whether there is such a file; false where that cannot be asked.
bool holds_file(const std::filesystem::path& file);

}  // namespace neuvv::training
