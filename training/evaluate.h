// A VOctree measured against the pictures of a data set.
#pragma once

#include <functional>
#include <vector>

#include "gpu/device.h"
#include "training/dataset.h"
#include "training/metrics.h"
#include "voctree/voctree.h"

namespace neuvv {

struct Evaluation {
    struct PerCamera {
        Quality quality;  // mean over its pictures
        uint32_t images = 0;
    };
    Quality mean;                    // over all pictures
    std::vector<PerCamera> cameras;  // by Dataset::cameras
    std::vector<Quality> views;      // by Dataset::views
};

// Called after each view with what was compared, both opaque; false ends the evaluation early.
using ViewCallback = std::function<bool(size_t view, const Image& truth, const Image& render, const Quality& quality)>;

// Renders every view with samples² rays a pixel and compares, both over white (see Quality), ignored
// pixels white in both. Where it ended early,
// means are over what was done. The tree must be sound (defect_of). Throws RuntimeFailure.
Evaluation evaluate(const Device& device, const VOctree& tree, const Dataset& dataset, uint32_t samples,
                    const ViewCallback& done = {});

// A view's picture over white; where its camera has a clean plate, without the captured background.
Image truth_over_white(const Dataset& dataset, const View& view);

}  // namespace neuvv
