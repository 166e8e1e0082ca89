// Makes mattes for a capture that has none, as files that load_dataset reads and a person can correct.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "training/mattes/camera_shots.h"
#include "training/mattes/difference.h"
#include "training/mattes/figure_mattes.h"

namespace neuvv::training {

struct MatteJob {
    std::filesystem::path dataset, output;  // output: the folder of the mattes
    std::filesystem::path from;             // mattes of another program (brought_mattes.h); empty: they are made
    std::filesystem::path model;            // an ONNX file of a network that makes them (matte_model.h), or empty
    bool inverted = false;                  // whether those of `from` are black where the performer is
    bool alone = false;                     // whether each image is judged by itself even where there are many cameras
    std::string format = "auto";            // of the data set
    MatteSettings settings;
};

struct MatteSummary {
    uint64_t images = 0;
    uint32_t cameras = 0, cameras_with_plate = 0;
    bool shows_performer = false;             // whether any pixel of any matte counts as performer
    double white_borders = 0;                 // which share of all images' borders is white
    Note missing_split;                       // why one of the two splits was left out; else empty
    Note alone;                               // why the cameras were not looked at together; else empty
    std::vector<CameraAgreement> agreements;  // worst first; empty where the cameras were not looked at together
    std::vector<std::string> sheet;           // the cameras of the contact sheet, from its top
    std::vector<std::string> swapped;         // what is said of cameras that have each other's images
    std::vector<Note> wrong_plates;           // plates that are not used
};

// Writes output/NAME.png, 8-bit grey, for each image NAME of the training and the test split, pixel by pixel as the
// camera saw it (lens distortion is not undone), and output/contact_sheet.png (matte_files.h). A camera's background is
// its clean plate, else the median of its images. With kMinFigureCameras and more, all cameras are looked at together
// (figure_search.h), after those that have each other's images got their own; else each matte is an image's difference
// from its background.
//
// The value of a matte in `from` is its alpha where it has one, else its brightness. A network gets the background
// where it wants a plate, and sees each camera's images in order.
//
// Throws InputError where neither split can be read, where a camera has no plate and fewer than kMinMedianFrames
// images, where two images have one name, where find_brought_mattes or MatteNetwork does, and where a matte in `from`
// has not the size of its image; RuntimeFailure where a file cannot be written.
MatteSummary make_mattes(const MatteJob& job, const MatteProgress& progress);

// How many images have a matte in `output` already, perhaps corrected by hand. Throws InputError where neither split
// can be read.
uint64_t count_existing_mattes(const MatteJob& job);

}  // namespace neuvv::training
