// How far a mesh is from the clip that it was made of.
#pragma once

#include <span>

#include "interchange/mesh/mesh_image.h"

namespace neuvv::interchange {

// What the clip shows to a camera: premultiplied linear light without a background, and depths, as linear_image of
// engine/render makes it.
struct MeshView {
    stage::Camera camera;
    media::LinearImage image;
};

struct MeshLoss {
    double iou = 1;            // pixels that both cover by half or more / those that either does, of all views
    double depth_mean_mm = 0;  // the mean difference of depths where both do
    double depth_95_mm = 0;    // what 95 % of them are not beyond
    double psnr_db = 0;        // of images on white, all pixels of all views together
};
MeshLoss loss_of(const ColouredMesh& mesh, std::span<const MeshView> views);

}  // namespace neuvv::interchange
