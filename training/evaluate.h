// A VOctree measured against the images of a data set.
#pragma once

#include <functional>
#include <vector>

#include "gpu/device.h"
#include "training/dataset.h"
#include "training/metrics.h"
#include "voctree/voctree.h"

namespace neuvv::render {
class FrameRenderer;
}

namespace neuvv::training {

struct Evaluation {
    struct Group {
        Quality quality;  // mean over its images
        uint32_t images = 0;
    };
    Quality mean;                // over all images
    std::vector<Group> cameras;  // by Dataset::cameras
    std::vector<Group> frames;   // by Dataset::times
    std::vector<Quality> views;  // by Dataset::views
};

// Called after each view with what was compared, both opaque; false ends the evaluation early.
using ViewCallback =
    std::function<bool(size_t view, const media::Image& truth, const media::Image& render, const Quality& quality)>;

// Renders every view with samples² rays a pixel and compares, both over white (see Quality), ignored
// pixels white in both. Where it ended early,
// means are over what was done. The tree must be sound (defect_of). Throws RuntimeFailure.
Evaluation evaluate(const gpu::Device& device, const voctree::VOctree& tree, const Dataset& dataset, uint32_t samples,
                    const ViewCallback& done = {});

// Index into Dataset::times.
size_t frame_of_view(const Dataset& dataset, const View& view);

// A name for each camera: what its images' names begin with, up to a separator ("c00_f003", "c00_f017": "c00"), or
// its only image's name. Where that gives two cameras the same name, all are called by their numbers.
std::vector<std::string> camera_labels(const Dataset& dataset);

// At most `count` views, ascending, spread over cameras and times.
std::vector<size_t> spread_views(const Dataset& dataset, size_t count);

// What `renderer`, made for a field of `frames` frames, shows of a view, over white.
media::Image render_over_white(render::FrameRenderer& renderer, const Dataset& dataset, const View& view,
                               uint32_t frames, uint32_t samples);

// A view's image over white; where its camera has a clean plate, without the captured background.
media::Image truth_over_white(const Dataset& dataset, const View& view);

}  // namespace neuvv::training
