// The visual hull: where in space and time the cameras' mattes allow matter.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "training/dataset.h"

namespace neuvv::training {

struct HullCell {
    glm::vec3 centre;  // world, metres
    float radius;      // of the ball about it, metres
};

// For each cell one bit per dataset.times entry, ⌈times/32⌉ words a cell, low bit first. A bit is set where no camera
// that sees the cell whole finds only background (matte below 1/8) over the image of its ball, and at least two
// cameras see it (one where the data set has only one). Cells half outside an image, or on its
// ignored pixels, are not carved by it.
// Runs on all cores, one frame after the other.
std::vector<uint32_t> carve(const Dataset& dataset, const std::vector<HullCell>& cells);

inline size_t hull_words(const Dataset& dataset) {
    return (dataset.times.size() + 31) / 32;
}

// A box around everything that carving leaves, in metres; starts from dataset.box, or where the cameras look. Throws
// InputError where nothing is left: masks and poses do not fit together.
std::pair<glm::dvec3, glm::dvec3> hull_box(const Dataset& dataset);

}  // namespace neuvv::training
