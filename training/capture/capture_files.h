// The files of a data set that this program writes: what its images are called, and what transforms.json says of them.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stage/camera.h"

namespace neuvv::training {

std::string camera_name(size_t camera);               // "c03"
std::string image_name(size_t camera, size_t frame);  // "c03_f012"
std::string video_file(size_t camera);                // "videos/c03.mp4"

struct CapturedClip {
    std::span<const stage::Camera> cameras;  // all with the same lens
    std::vector<bool> written;               // by camera: whether the file names it
    uint32_t frames = 0;
    double fps = 25;
    std::pair<glm::dvec3, glm::dvec3> box;  // min, max in metres
    std::vector<bool> plates = {};          // by camera, whether it has a clean plate; empty: none has
    const char* ending = ".png";            // of images and plates
    bool videos = false;                    // the images of a camera are one video
};

// Writes a transforms.json (training/data/layouts/README.md), which names images and plates. The file is replaced
// atomically. Throws RuntimeFailure.
void write_transforms(const std::filesystem::path& file, const CapturedClip& clip);

}  // namespace neuvv::training
