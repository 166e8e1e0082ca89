// The pixels of a rig.
#pragma once

#include "training/rig.h"

namespace neuvv::training {

// What the images of a rig take in memory, plates and masks left out: by the calibration's sizes, else by the header
// of one image a camera.
struct ImageMemory {
    uint64_t images = 0, cameras = 0, frames = 0;
    uint32_t width = 0, height = 0;  // of the largest
    uint64_t bytes = 0;
};
ImageMemory image_memory(const Rig& rig);

// Reads every image, mask and plate that the rig names, on all cores. Throws InputError for images that cannot be
// read or whose sizes disagree, and where mattes are needed and no image has one.
Dataset read_images(const Rig& rig, const LoadOptions& options);

}  // namespace neuvv::training
