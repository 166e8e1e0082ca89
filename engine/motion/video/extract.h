// A performer's skeleton from key points of many views: triangulation of each frame, then one fit over the whole clip.
#pragma once

#include <array>

#include "motion/skeleton/skeleton.h"
#include "motion/video/key_points.h"

namespace neuvv::motion {

struct ExtractOptions {
    bool bundle = true;  // false: triangulation alone, to see what the fit over time is worth
};

// How good an extraction is.
struct ExtractQuality {
    // By joint: the median distance between where the joint is seen and where it is shown, as a share of the body's
    // height; the share of the frames in which it was triangulated.
    std::array<double, kJoints> error{}, known{};
    size_t swapped = 0;     // arms and legs of images whose left and right were exchanged
    double height_m = 0;    // of the body
    size_t outliers = 0;    // key points that contradict the other views
    size_t key_points = 0;  // of all views and frames
};

struct Extraction {
    SkeletonClip clip;
    ExtractQuality quality;
};

// Positions are in the cameras' world. A joint that fewer than two views agree on is interpolated and counts as
// estimated. Throws InputError where no frame has a leg and a trunk.
Extraction extract_skeleton(const Detections& detections, const ExtractOptions& options);

}  // namespace neuvv::motion
