// Reads the images of a rig.
#pragma once

#include "training/data/dataset.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// How many images a rig has, and how many bytes all their pixels are, background included. Sizes are those of the
// calibration, else those of one image per camera, of which only the header is read.
struct ImageCount {
    uint64_t images = 0, cameras = 0, frames = 0;
    uint32_t width = 0, height = 0;  // the largest ones
    uint64_t bytes = 0;
};
ImageCount image_count(const Rig& rig);

// The cameras of a rig without distortion, with the sizes of their images, of which one a camera may be opened.
std::vector<stage::Camera> cameras_of(const Rig& rig);

// Memory for the images of a rig, of which the part that exceeds the options' budget lies on disk.
std::shared_ptr<SpooledMemory> make_spool(const Rig& rig, const LoadOptions& options);

// Reads every image, mask and plate that the rig names, on all cores. Throws InputError for images that cannot be read
// or whose sizes disagree, and where mattes are needed and no image has one; RuntimeFailure where the disk has no room
// for what exceeds the memory.
Dataset read_images(const Rig& rig, const LoadOptions& options);

}  // namespace neuvv::training
