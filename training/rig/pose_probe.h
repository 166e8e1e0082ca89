// How the images of the current field depend on the poses of cameras, by central differences of renders: leaves are
// constant inside, so that an exact derivative says how edges of leaves move, not how the image does.
#pragma once

#include "training/rig/pose_solver.h"
#include "training/step/step.h"

namespace neuvv::training {

constexpr uint32_t kPoseVariants = 1 + 2 * kPoseNumbers;  // the camera as it is, and with each number more and less

// What a probe compares: the field at a frame as cameras see it, with the pixels of a batch.
struct PoseProbe {
    const std::vector<stage::Camera>& given;  // the cameras of the data set
    const std::vector<PoseChange>& changes;   // by camera
    const CameraColours& colours;             // empty: neutral
    glm::dvec3 centre;                        // of the scene
    double pixels;                            // by how much the image moves for a difference
};

// Adds to the evidence of each camera what the tiles of a batch say. The tiles of a camera must follow each other, with
// one ray a pixel, and the step must have room for kPoseVariants cameras and tiles (assert). Bound by the trace of
// kPoseVariants rays a pixel, and by the encoding of their colours on the host.
void add_evidence(TrainingStep& step, const PoseProbe& probe, const Batch& batch, float frame,
                  std::vector<PoseEvidence>& evidence);

}  // namespace neuvv::training
