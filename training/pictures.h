// The pixels of a rig.
#pragma once

#include "training/rig.h"

namespace neuvv::training {

// What the pictures of a rig take in memory, plates and masks left out: by the calibration's sizes, else by the header
// of one picture a camera.
struct PictureNeed {
    uint64_t pictures = 0, cameras = 0, frames = 0;
    uint32_t width = 0, height = 0;  // of the largest
    uint64_t bytes = 0;
};
PictureNeed picture_need(const Rig& rig);

// Reads every picture, mask and plate that the rig names, on all cores. Throws InputError for pictures that cannot be
// read or whose sizes disagree, and where mattes are needed and no picture has one.
Dataset read_pictures(const Rig& rig, const LoadOptions& options);

}  // namespace neuvv::training
