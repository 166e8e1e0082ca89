// The images of what stands around the performer: what cameras show outside its mattes.
#pragma once

#include "training/data/dataset.h"

namespace neuvv::training {

// One opaque image of each camera, all at one time. Of a camera with a clean plate it is that, unless its images show
// another place (background_of); of one with several images, their median at each pixel where mattes do not cover it.
// Pixels that mattes always cover, or nearly, and those that masks exclude are ignored. Images without mattes are taken
// whole. Dataset::remarks name plates that are not used. Throws InputError as read_images() does, and where the images
// show one colour alone outside the mattes, as images that were cut out do.
//
// Images with a side of four times `longest` pixels and more are reduced to two to four times as many.
Dataset read_surroundings(const Rig& rig, const LoadOptions& options, uint32_t longest);

// Both read one image of each camera. Whether one has a pixel that its matte leaves out.
bool has_mattes(const Rig& rig);
// Throws InputError where it is clear before a run that no surroundings can be learnt.
void expect_surroundings(const Rig& rig);

}  // namespace neuvv::training
