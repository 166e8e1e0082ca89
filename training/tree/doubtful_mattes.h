// Mattes that contradict the other images of their time, so that they do not carve the body away.
#pragma once

#include <cstdint>
#include <vector>

#include "training/data/dataset.h"

namespace neuvv::training {

struct DoubtfulMatte {
    uint32_t view = 0;  // index into Dataset::views
    float share = 0;    // of the body's cells: those that this matte empties, perhaps with a few others
};

// Finds the images whose mattes lack a part of the body, and ignores their background pixels (View::ignored) wherever
// the hull of the other images lies: these pixels then neither carve nor teach emptiness.
//
// A right matte often is the only one to empty a cell, but all images' foreground still has matter of the hull behind
// it. Where a part is missing in one matte, the other images show foreground behind which no matter is left. A matte is
// doubtful if it empties at least kDoubtfulShare of the body's cells behind such unexplained foreground. In each cell
// fewer than a quarter of the images that see it can be wrong, and more images than can be wrong must show unexplained
// foreground there. A time with fewer than five images is left as it is.
std::vector<DoubtfulMatte> ignore_doubtful_mattes(Dataset& dataset);

constexpr float kDoubtfulShare = 0.01f;

}  // namespace neuvv::training
