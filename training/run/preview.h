// An image of a model during its training: truth, render and error of one view, side by side.
#pragma once

#include <filesystem>

#include "render/volume/slices/field.h"
#include "training/data/dataset.h"
#include "training/evaluation/metrics.h"

namespace neuvv::training {

// A data set with a single view, the one that previews show: of the first view's camera, the view that is nearest to
// the centre of the clip. Needs a view (assert).
Dataset preview_dataset(const Dataset& dataset);

// Renders view 0 of `dataset` from `field`, which nothing else may use at the same time, and atomically replaces `file`
// (a PNG) with truth, render and error side by side, all over white. Returns the quality of the render. Throws
// RuntimeFailure.
Quality write_preview(const gpu::Device& device, const render::Field& field, const Dataset& dataset,
                      const std::filesystem::path& file);

}  // namespace neuvv::training
