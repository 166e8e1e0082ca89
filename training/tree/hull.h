// The visual hull: where in space, and at which times, the mattes of the cameras allow matter.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "training/data/dataset.h"

namespace neuvv::training {

struct HullCell {
    glm::vec3 centre;  // world, metres
    float radius;      // of the ball that stands for the cell, metres
};

// For each cell one bit per time of the data set: hull_words() words per cell, low bit first. A bit is set where the
// cell may hold matter at that time: at least two cameras (one, where only one has an image) see foreground in the
// image of the cell's ball, and no camera that sees the whole ball finds only background there (matte below 1/8). An
// image never empties a ball that lies partly outside it, or in which it has ignored pixels.
// Runs on all cores, one time after the other.
std::vector<uint32_t> carve(const Dataset& dataset, const std::vector<HullCell>& cells);

// Words of carve()'s bits per cell: ⌈times/32⌉.
inline size_t hull_words(const Dataset& dataset) {
    return (dataset.times.size() + 31) / 32;
}

constexpr uint32_t kBoxGrid = 48;  // cells along each side of the grid with which a box is searched

// The cells of a grid over a box, `side` along each axis, each with the ball that encloses it.
std::vector<HullCell> grid_cells(const std::pair<glm::dvec3, glm::dvec3>& box, uint32_t side);

}  // namespace neuvv::training
