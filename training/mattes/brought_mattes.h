// Which file of another program is the matte of which image.
#pragma once

#include <filesystem>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// The matte of each shot, by rig and in the order of the rig's shots. An image PLACE/CAMERA/NAME.EXT has, in this
// order, the first of these that is in the folder:
//
// - the shot's own name, as `neuvv matte` and training name mattes;
// - the image's path, whole (COLMAP's masks/) or without its first folders (CAMERA/NAME, NAME), with EXT, or another
//   ending, or another ending after EXT (NAME.jpg.png);
// - the camera's name and the image's, joined by a slash, "_" or "-";
// - a frame of the video CAMERA: that of the image's own number in its video, else that of its place in time among the
//   images of its camera.
//
// Throws InputError where an image has none, and where one file would be the matte of two images.
std::vector<std::vector<ImageSource>> find_brought_mattes(const std::filesystem::path& folder,
                                                          const std::vector<Rig>& rigs);

}  // namespace neuvv::training
