// Cameras whose mattes contradict those of all others: their images are of another camera, or show something else.
#pragma once

#include <cstdint>
#include <vector>

#include "training/data/dataset.h"

namespace neuvv::training {

// What a camera and the hull of the others say of each other. Both shares are 0 where they agree, however few the
// others are, and however little of the scene a camera sees.
struct CameraFit {
    double unexplained = 0;  // of the camera's foreground: where the others deny all matter behind it
    // Of the others' foreground: where this camera denies the matter behind it. Where two do so, each has half of it.
    double denied = 0;
};

// Each shows what the other should see.
struct SwappedCameras {
    uint32_t a = 0, b = 0;  // indices into Dataset::cameras; a < b
    // Of the foreground of an image, the mean over the cameras: where others deny all matter behind it.
    double unexplained = 0, unexplained_swapped = 0;
};

struct Misfit {
    uint32_t camera = 0;
    CameraFit fit;
};

struct Misfits {
    std::vector<SwappedCameras> swapped;
    std::vector<Misfit> others;  // in the order of their cameras
};

// With fewer cameras, it is not known which of them contradict the others.
constexpr size_t kMinJudgedCameras = 5;
// How many cameras may be misfits: two fifths, so many that four are left, and twelve at most.
size_t most_misfits(size_t cameras);

// Judges the cameras by all images of `look`, a few times of a data set. A camera's shares are the medians over these
// times, so that single wrong mattes count little. Two cameras are swapped if all agree once these have each other's
// images, and did not before. Others are misfits only if they contradict the rest by more than a pose or a clock that
// is a little off, and the rest agrees.
Misfits find_misfits(const Dataset& look);

}  // namespace neuvv::training
