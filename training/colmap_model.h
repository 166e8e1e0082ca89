// A sparse model of COLMAP as its files hold it, binary or text: lenses, posed images, points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/rig.h"

namespace neuvv::training {

struct ColmapModel {
    std::string file;                // images.bin or images.txt, for errors
    std::vector<RigCamera> images;   // one an image, at least one; named as the files do ("cam00/0001.jpg"), distinct
    std::vector<std::string> place;  // by image, where in the file: "line 12", "image 3"
    std::vector<glm::dvec3> points;  // empty where there is no points3D file
};

bool holds_colmap_model(const std::filesystem::path& folder);

// Reads cameras, images and points3D, .bin before .txt, and nothing else (rigs, frames). Throws InputError naming file
// and place for anything missing, truncated, unknown or not finite, and counts beyond the file's end.
ColmapModel read_colmap_model(const std::filesystem::path& folder);

}  // namespace neuvv::training
