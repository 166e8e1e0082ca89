// An image of a model while it is trained: truth, render and error of one view, side by side.
#pragma once

#include <filesystem>

#include "render/field.h"
#include "training/dataset.h"
#include "training/metrics.h"

namespace neuvv::training {

// The data set cut down to the view that previews show: of its first camera, the time next to the clip's middle.
Dataset preview_dataset(const Dataset& dataset);

// Renders view 0 of `dataset` from `field`, which nothing else may use meanwhile, and replaces `file` (a PNG)
// atomically by truth | render | error, all over white. The field's frames span the clip. Returns how good the render
// is. Throws RuntimeFailure.
Quality write_preview(const gpu::Device& device, const render::Field& field, const Dataset& dataset,
                      const std::filesystem::path& file);

}  // namespace neuvv::training
