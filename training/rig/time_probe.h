// By how much a camera is late, from how well its images fit the field at the frames beside their own.
#pragma once

#include "training/step/camera_colour.h"
#include "training/step/step.h"

namespace neuvv::training {

// Sums of absolute differences of a camera's images, asked about the next frame, and asked about the previous one.
struct TimeEvidence {
    struct Sums {
        double own = 0;     // between images and renders at their own frame
        double beside = 0;  // between images and renders at the frame beside it
        double motion = 0;  // between the two renders
    };
    Sums next, previous;

    // The frames by which the camera's shutter is late, −1 to 1; 0 where nothing moves. Half a frame later, an image is
    // as far from its own frame as from the next one. An error of the camera's pose raises all differences, and not
    // always alike: where it is as large as the motion, this is of no use.
    double frames_late() const;
    // The motion as a share of the difference at the own frame; 0 where images of one side are missing.
    double contrast() const;
};

// Adds what the tiles of a batch say, with renders at its frame and at the frame beside it. Bound by two traces of the
// batch.
void add_time_evidence(TrainingStep& step, const std::vector<stage::Camera>& cameras, const CameraColours& colours,
                       const Batch& batch, uint32_t frame, uint32_t beside, std::vector<TimeEvidence>& evidence);

}  // namespace neuvv::training
