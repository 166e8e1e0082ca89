// The first tree of what stands around the performer, as far as cameras see (`neuvv train --background learn`).
//
// An octree needs no contracted space for that: far leaves are large. A leaf is as large as a few pixels of the camera
// nearest to it, whatever its distance, so that each doubling of distances takes about as many leaves.
#pragma once

#include "training/data/dataset.h"
#include "voctree/voctree.h"

namespace neuvv::training {

// So many levels do the leaves of the first tree lie above the finest ones.
constexpr uint32_t kSurroundingsLevels = 4;
// Leaves along the longer side of an image: what a user chose, or 200. More show cameras between others less well
// (training/RESULTS.md, "Surroundings").
inline uint32_t resolution_around(uint32_t chosen) {
    return chosen > 0 ? chosen : 200;
}

// How many pixels of the camera nearest to it the edge of a finest leaf covers with so many leaves along the longer
// side of the largest image. At least one.
double leaf_pixels_of(const Dataset& dataset, uint32_t resolution);

// The first tree. Its box is a cube around the point that all cameras look at; it reaches kSurroundingsReach times as
// far as cameras stand from there. Its leaves cover up to 2^kSurroundingsLevels · `leaf_pixels` pixels of the nearest
// camera. They are faintly opaque, wherever enough cameras look, but not right before a camera. No finest leaf is
// smaller than 1/4096 of the box. The data set has one time. Throws InputError where all cameras look the same way, and
// where no leaf is left.
voctree::VOctree surroundings_tree(const Dataset& dataset, double leaf_pixels, uint32_t hh_degree);

}  // namespace neuvv::training
