// Mattes for a capture that has none, as files which load_dataset reads and a person can correct.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "training/matte.h"
#include "training/rig.h"

namespace neuvv::training {

constexpr uint32_t kMaxMedianFrames = 31;  // of a camera without clean plate, at most so many images are held
constexpr uint32_t kMinMedianFrames = 5;   // and fewer tell nothing

struct MatteJob {
    std::filesystem::path dataset, output;  // output: the folder of the mattes, made where missing
    std::filesystem::path from;             // mattes of another program, taken as they are; empty: difference matting
    std::string format = "auto";            // of the data set
    MatteSettings settings;
};

struct MatteSummary {
    uint64_t images = 0;
    uint32_t cameras = 0, cameras_with_plate = 0;
    std::string missing_split;  // why one of the two splits has none: a data set need not have both
};

// Images done, of how many; false stops.
using MatteProgress = std::function<bool(uint64_t done, uint64_t total)>;

// Writes output/NAME.png, 8-bit grey, for each image NAME of both splits, in the camera's own pixels (lens
// distortion, where there is any, included), and output/contact_sheet.png: image, matte, and the performer over
// magenta, for images spread over the cameras. A camera's background is its clean plate, else the median of its
// images.
//
// In `from` the matte of image NAME is NAME.png, or the image's own file name as PNG, or the same frame of the
// video CAMERA.mov, .webm, .mkv or .mp4; its alpha where it has one, else its brightness.
//
// Throws InputError: neither split can be read, a camera with neither plate nor kLeastMedianFrames images, two
// images of one name, a matte missing in `from` or of another size than its image. RuntimeFailure: not writable.
MatteSummary make_mattes(const MatteJob& job, const MatteProgress& progress);

// Images whose matte is in `output` already, perhaps corrected by hand.
uint64_t count_existing_mattes(const MatteJob& job);

}  // namespace neuvv::training
