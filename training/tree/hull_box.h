// Where the performer is: the box and the coarse cells that the visual hull leaves.
#pragma once

#include <glm/glm.hpp>
#include <utility>

#include "training/data/dataset.h"
#include "training/tree/hull.h"

namespace neuvv::training {

// The box with which a search begins: dataset.box, or else where the cameras look. Throws InputError where all cameras
// look in the same direction and there is no dataset.box.
std::pair<glm::dvec3, glm::dvec3> first_box(const Dataset& dataset);

// Where matter is at any time, in cells of some centimetres. Left out of the hull are parts that touch nothing else,
// that fewer than a third of a time's cameras see whole, and that no foreground pixel needs, as other cells lie on its
// ray: such parts arise where the images of most cameras end.
struct MatterGrid {
    std::pair<glm::dvec3, glm::dvec3> box;        // min, max in the world, metres, of a grid of kBoxGrid³ cells
    std::pair<glm::dvec3, glm::dvec3> tight_box;  // of the cells that hold matter
    std::vector<bool> matter;                     // by cell, in the order of grid_cells()

    // Whether a box of the world touches a cell that holds matter.
    bool overlaps(const std::pair<glm::dvec3, glm::dvec3>& other) const;
};

// Throws InputError as first_box does, and where no matter is left, as mattes and poses then do not fit together.
MatterGrid find_matter(const Dataset& dataset);

// The box around all matter: MatterGrid::tight_box.
std::pair<glm::dvec3, glm::dvec3> hull_box(const Dataset& dataset);

}  // namespace neuvv::training
