// A sparse model of COLMAP, read from its binary or text files: lenses, posed images, points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

struct ColmapModel {
    std::string file;                // images.bin or images.txt, for errors
    std::vector<RigCamera> images;   // a camera per image, at least one; distinct names, as in the files ("cam/01.jpg")
    std::vector<std::string> place;  // by image: where in the file it stands ("line 12", "image 3 of 9")
    std::vector<glm::dvec3> points;  // empty where there is no points3D file
};

bool holds_colmap_model(const std::filesystem::path& folder);

// How many images the model places; 0 where its file of images is damaged.
size_t placed_images(const std::filesystem::path& folder);

// Reads the files cameras, images and points3D, .bin rather than .txt where both exist. Throws InputError with file and
// place for anything missing, truncated, unknown or not finite, and for counts beyond the file's end.
ColmapModel read_colmap_model(const std::filesystem::path& folder);

}  // namespace neuvv::training
