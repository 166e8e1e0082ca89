// Makes mattes for a capture that has none, as files that load_dataset reads and a person can correct.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "training/data/layouts/rig/rig.h"
#include "training/data/matte.h"

namespace neuvv::training {

// With fewer images of a camera without clean plate, their median says nothing about the background.
constexpr uint32_t kMinMedianFrames = 5;

struct MatteJob {
    std::filesystem::path dataset, output;  // output: the folder of the mattes
    std::filesystem::path from;             // mattes of another program (brought_mattes.h); empty: difference matting
    bool inverted = false;                  // whether those are black where the performer is
    std::string format = "auto";            // of the data set
    MatteSettings settings;
};

struct MatteSummary {
    uint64_t images = 0;
    uint32_t cameras = 0, cameras_with_plate = 0;
    bool shows_performer = false;  // whether any pixel of any matte counts as performer
    double white_borders = 0;      // of mattes of another program: which share of all images' borders is white
    Note missing_split;  // why one of the two splits was left out, as a data set need not have both; else empty
};

// Receives how many images are done, and of how many; returns false to stop.
using MatteProgress = std::function<bool(uint64_t done, uint64_t total)>;

// Writes output/NAME.png, 8-bit grey, for each image NAME of the training and the test split, pixel by pixel as the
// camera saw it (lens distortion is not undone), and output/contact_sheet.png with image, matte, and the performer over
// magenta, for images spread over the cameras. A camera's background is its clean plate, else the median of its images.
//
// The value of a matte in `from` is its alpha where it has one, else its brightness.
//
// Throws InputError where neither split can be read, where a camera has no plate and fewer than kMinMedianFrames
// images, where two images have one name, where find_brought_mattes does, and where a matte in `from` has not the size
// of its image;
// RuntimeFailure where a file cannot be written.
MatteSummary make_mattes(const MatteJob& job, const MatteProgress& progress);

// What already says in this data set which pixels show the performer: mattes/, masks that mean mattes, or an alpha of
// the images, of which one image of each of a few cameras is read. In the order in which they count: each overrules
// those behind it. Empty where there is none. Throws InputError where neither split can be read.
std::vector<std::string> matte_sources(const MatteJob& job);
std::vector<std::string> matte_sources(const std::vector<Rig>& splits);

// How many images have a matte in `output` already, perhaps corrected by hand. Throws InputError where neither split
// can be read.
uint64_t count_existing_mattes(const MatteJob& job);

}  // namespace neuvv::training
