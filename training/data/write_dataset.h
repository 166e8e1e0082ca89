// Writes a data set of any layout as files that other programs read: images without lens distortion.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "base/error.h"
#include "training/data/both_splits.h"

namespace neuvv::training {

// `written_by` of the transforms files (transforms_file.h).
constexpr const char* kWrittenBy = "neuvv dataset";
// The folders and files of such a data set. The last are those that say that the others are whole.
constexpr const char* kWrittenFolders[] = {"images", "mattes", "masks", "plates"};
constexpr const char* kWrittenFiles[] = {"transforms_val.json", "transforms_test.json", "transforms_train.json"};

struct WriteSummary {
    bool complete = false;  // false: the caller stopped it
    uint64_t images = 0, train_cameras = 0, test_cameras = 0, val_cameras = 0, plates = 0;
    bool mattes = false, masks = false;
    Note missing_split;  // why one of training and test was left out, as a data set need not have both; else empty
    std::vector<std::string> remarks;  // what the reader of the layout decided, of all splits
};

// Receives how many images are done, and of how many; returns false to stop.
using WriteProgress = std::function<bool(uint64_t done, uint64_t total)>;

// Writes output/transforms_train.json, transforms_test.json and transforms_val.json, of splits that there are, in the
// coordinates of the capture with +Y up, and
// - images/NAME.png, straight alpha being the matte, with what the camera saw where alpha is 0;
// - mattes/NAME.png, that alpha in grey, where the data set has mattes;
// - masks/NAME.png, black where nothing is known of a pixel, where there are such pixels (nerfstudio's mask_path);
// - plates/CAMERA.png, the clean plates.
// Images are reduced `reduction` times (reduce.h).
// NAME is what the image's name has from its camera's name on ("01_0003" of "images_01_0003"). What is read from these
// files is what is read from the data set itself. Throws InputError for images that cannot be read or are smaller than
// a reduced pixel, and where two have one name; RuntimeFailure where a file cannot be written.
WriteSummary write_dataset(const BothSplits& both, const std::filesystem::path& output, const WriteProgress& progress,
                           uint32_t reduction = 1);

}  // namespace neuvv::training
