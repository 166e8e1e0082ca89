// Renders a volumetric video from all around, as a data set in which a 2D detector finds the performer's joints.
#pragma once

#include <cstdint>
#include <filesystem>

#include "gpu/device.h"
#include "training/capture/capture.h"
#include "voctree/voctree.h"

namespace neuvv::training {

struct ViewSettings {
    uint32_t views = 14;
    uint32_t width = 512, height = 512;
};

// The cameras: around the clip's leaves in two rings, so that arms and legs that hide each other in one are seen in the
// other. Every view shows all of the clip.
std::vector<stage::Camera> views_around(const voctree::VOctree& clip, const ViewSettings& settings);

// Writes folder/images/cNN_fNNN.png, the performer before grey, and last folder/transforms_train.json. Returns false
// where the caller stopped it; the folder then has no transforms. Throws InputError for settings that are out of range,
// RuntimeFailure for what the machine cannot do.
bool render_performer_views(const gpu::Device& device, const voctree::VOctree& clip,
                            const std::filesystem::path& folder, const ViewSettings& settings,
                            const CaptureProgress& progress);

}  // namespace neuvv::training
