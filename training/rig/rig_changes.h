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

    bool empty() const { return poses.empty() && frames_late.empty(); }
    bool operator==(const RigChanges&) const = default;
};

constexpr double kMostFramesLate = 1;  // more cannot be told from images of two neighbouring frames

// A camera that is found further from all whole frames shows the performer as no frame of the clip has it. What is
// found falls short of the truth, as the camera's own images are part of the draft: half a frame is found as 0.2
// (RESULTS.md).
constexpr double kMostOffFrame = 0.12;

// Whether a camera's images are of no use, by how late it is.
bool is_between_frames(double frames_late);

// By camera, whether its images are left out: those between frames, unless they are more than a quarter of all. Then
// the rig as a whole has no common frames, and images that blend them are better than none.
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
// changes must be of as many cameras (assert).
void apply(const RigChanges& changes, Dataset& dataset);

}  // namespace neuvv::training
