// What the files of images say about how they are shown: turned, mirrored, in other colours. Videos are turned as
// players turn them, since every extractor of frames does it, too. Exif turns a still image for programs that read by
// OpenCV, and for none of those that find cameras by structure from motion (COLMAP, Metashape, RealityCapture and the
// readers of their results): what counts is what the calibration was made from.
#pragma once

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// Whether the image is used as it is stored: by the shape that the calibration is for, where only one orientation has
// it, else by `by_default`.
bool used_as_stored(const ImageSource& image, const interchange::Lens& lens, bool by_default);

// Sets ImageSource::as_stored of all images, masks and plates by each camera's first image, and adds remarks on what
// the files say, by camera. It reads headers alone.
void settle_presentation(Rig& rig);

// Adds one remark for each text, with the names of its cameras.
using TextsByCamera = std::vector<std::pair<std::string, std::string>>;  // the camera's name, what is said of it
void add_remarks(Rig& rig, const TextsByCamera& texts);

}  // namespace neuvv::training
