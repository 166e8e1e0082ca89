// Writes a transforms.json (layouts/README.md).
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stage/camera.h"

namespace neuvv::training {

struct WrittenFrame {
    size_t camera = 0;               // index into WrittenTransforms::cameras
    std::optional<double> time;      // [0,1]; nothing: `image` is a video of the camera
    std::string image, plate, mask;  // paths inside the file's folder; plate and mask may be empty
};

struct WrittenTransforms {
    std::span<const stage::Camera> cameras;
    std::vector<WrittenFrame> frames;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // min, max, in the cameras' coordinates
    double fps = 0;                                        // 0: not known
    std::string written_by;  // a member of that name, by which the program knows its own files; empty: none
};

// The file is replaced atomically. Intrinsics that all frames share stand once. Throws RuntimeFailure.
void write_transforms_file(const std::filesystem::path& file, const WrittenTransforms& transforms);

}  // namespace neuvv::training
