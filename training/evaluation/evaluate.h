// Measures a VOctree against the images of a data set.
#pragma once

#include <functional>
#include <vector>

#include "gpu/device.h"
#include "training/data/dataset.h"
#include "training/evaluation/metrics.h"
#include "voctree/files/clip_index.h"
#include "voctree/voctree.h"

namespace neuvv::render {
class FrameRenderer;
struct Instance;
}  // namespace neuvv::render

namespace neuvv::training {

// What of the images is compared, of a view whose truth has a matte; all of it where the matte is empty.
enum class ComparedPart : uint8_t {
    kImage,
    kRectangle,  // the smallest that holds all pixels of the matte with alpha above 0
    kMatte,      // the same; PSNR of these pixels alone
};

struct CompareSettings {
    uint32_t samples = 1;  // rays per pixel along each side
    ComparedPart part = ComparedPart::kImage;
    const uint8_t* background = media::kWhite;  // RGB, behind truth and render
};

struct Evaluation {
    struct Group {
        Quality quality;  // mean over the group's images
        uint32_t images = 0;
    };
    Quality mean;                // over all images
    std::vector<Group> cameras;  // in the order of Dataset::cameras
    std::vector<Group> frames;   // in the order of Dataset::times
    std::vector<Quality> views;  // in the order of Dataset::views; those that were not compared have quality 0
    size_t compared = 0;         // how many views were
};

// Called after each view with the two images that were compared, both whole and opaque; returns false to end the
// evaluation.
using ViewCallback =
    std::function<bool(size_t view, const media::Image& truth, const media::Image& render, const Quality& quality)>;

// Renders every view and compares it with the data set's image, both over the background (see Quality). Ignored pixels
// show the background in both. After an early end, means are over the views that were compared. Views are in their
// order, but of a clip segment by segment: those that are shown and the next one are in memory; a segment fades into
// the next as players show it. The tree must be sound (voctree::defect_of). Throws RuntimeFailure, and InputError where
// a segment cannot be read.
Evaluation evaluate(const gpu::Device& device, const voctree::VOctree& tree, const Dataset& dataset,
                    const CompareSettings& settings, const ViewCallback& done = {});
Evaluation evaluate(const gpu::Device& device, const voctree::ClipIndex& clip, const Dataset& dataset,
                    const CompareSettings& settings, const ViewCallback& done = {});

// The part of an image of the view that is compared; a rectangle is at least so many pixels wide and high, or as many
// as the image.
media::Image compared_part(const media::Image& image, const View& view, ComparedPart part, uint32_t least_side = 1);
// Both images are whole.
Quality compare_part(const media::Image& truth, const media::Image& render, const View& view, ComparedPart part);

// A view and the frame of a segment's tree that it shows.
struct ViewFrame {
    size_t view;  // index into Dataset::views
    float frame;
};

// By segment of the clip, the data set's views, in their order.
std::vector<std::vector<ViewFrame>> views_by_segment(const voctree::ClipIndex& clip, const Dataset& dataset);

// The view's frame: an index into Dataset::times.
size_t frame_of_view(const Dataset& dataset, const View& view);

// A name for each camera: that of the files, else names_by_images, else numbers.
std::vector<std::string> camera_labels(const Dataset& dataset);

// Indices of at most `count` views, ascending, spread over cameras and times.
std::vector<size_t> spread_views(const Dataset& dataset, size_t count);

// Renders what a camera sees of some instances, marched together, over a background, which the view's ignored pixels
// show, too.
media::Image render_over(render::FrameRenderer& renderer, const stage::Camera& camera, const View& view,
                         std::vector<render::Instance> instances, uint32_t samples,
                         const uint8_t background[3] = media::kWhite);

}  // namespace neuvv::training
