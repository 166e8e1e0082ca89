// What a run corrects of a data set's rig before it begins (`--refine poses,time`).
#pragma once

#include "training/data/dataset.h"
#include "training/rig/camera_pose.h"

namespace neuvv::training {

// By camera; empty vectors change nothing.
struct RigChanges {
    std::vector<PoseChange> poses;
    // The frames by which the camera's shutter is late: its image of frame t shows the performer at t + this.
    std::vector<double> frames_late;

    // The frames by which the bottom of the camera's images is later than their top, beyond what all cameras have in
    // common: a rolling shutter.
    std::vector<double> readout;

    bool empty() const { return poses.empty() && frames_late.empty() && readout.empty(); }
    bool operator==(const RigChanges&) const = default;
};

constexpr double kMostFramesLate = 1;  // more cannot be told from images of two neighbouring frames

// A camera that is found further from all whole frames shows the performer as no frame of the clip has it. What is
// found falls short of the truth, as the camera's own images are part of the draft: half a frame was found as 0.3, and
// in clean rigs up to 0.05.
constexpr double kMostOffFrame = 0.12;

// With a longer readout, the first and last rows of a camera are as far from frames as the images of one between them.
// Clean rigs seem to have readouts of up to 0.4, though not with certainty.
constexpr double kMostReadout = 0.4;
constexpr double kLongestReadout = 10;  // that is taken for a number of frames

// Whether a camera's images are of no use, by how late it is.
bool is_between_frames(double frames_late);

// By camera, whether its images are left out: those between frames, unless they are more than a quarter of all. Then
// the rig as a whole has no common frames, and images that blend them are better than none. So are those of rolling
// shutters, unless they and the others are more than a quarter.
std::vector<bool> left_out(const RigChanges& changes);

// What the change of one camera's pose comes to.
struct RefinedPose {
    PoseChange change;
    double motion_px;  // image_motion() of the change
    bool at_bound;
};
// By camera; empty where poses do not change. To be called before apply().
std::vector<RefinedPose> refined_poses(const RigChanges& changes, const Dataset& dataset);

// Moves the cameras, moves images of cameras that are late by whole frames to the frames that they show, and removes
// images that are left out or beyond the clip. Throws InputError where a frame would be left without an image. The
// changes must be of as many cameras (assert); images are left out only where `frames_late` is not empty.
void apply(const RigChanges& changes, Dataset& dataset);

}  // namespace neuvv::training
