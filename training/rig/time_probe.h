// By how much a camera is late, its shutter rolls, and is open, from how well its images fit the field at the frames
// beside their own.
#pragma once

#include <array>
#include <limits>

#include "training/step/camera_colour.h"
#include "training/step/step.h"

namespace neuvv::training {

constexpr size_t kRowBands = 8;

// Fewer bands of rows always lie near a line. Each counts by its share of the motion.
constexpr double kLeastBands = 3.5;

// By how many frames the bottom of an image is later than its top, and the standard deviation of that, which follows
// from how far bands of rows lie off a line; infinite where too few bands move.
struct Readout {
    double frames = 0, deviation = std::numeric_limits<double>::infinity();
};

// What a camera's images say when they are asked about the next frame, and about the previous one, by bands of rows
// from the top of the image to its bottom.
struct TimeEvidence {
    struct Sums {
        double along = 0;  // (image − render at its frame) · (render at the frame beside it − render at its frame)
        double motion = 0;  // the square of the latter
        double error = 0;   // the square of the former

        Sums& operator+=(const Sums& other);
    };
    using Bands = std::array<Sums, kRowBands>;
    Bands next, previous;

    // The frames by which the camera's shutter is late, −1 to 1; 0 where nothing moves: the share of the way to the
    // next frame, less that to the previous one, of a least squares fit. An error of the camera's pose is no motion,
    // and not always alike on both ways: where it is as large as the motion, this is of no use.
    double frames_late() const;
    Readout readout() const;
    // The exposure in frames, less some number that all cameras of a draft have in common: what moves is seen before
    // and behind where it is at its frame, by an eighth of the exposure each.
    double blur() const;
    // The motion as a share of the difference at the own frame; 0 where images of one side are missing.
    double contrast() const;
    TimeEvidence& operator+=(const TimeEvidence& other);
};

// Adds what the tiles of a batch say, with renders at its frame and at the frame beside it. Bound by two traces of the
// batch.
void add_time_evidence(TrainingStep& step, const std::vector<stage::Camera>& cameras, const CameraColours& colours,
                       const Batch& batch, uint32_t frame, uint32_t beside, std::vector<TimeEvidence>& evidence);

}  // namespace neuvv::training
