// `neuvv train --refine poses`: corrects the poses and focal lengths of cameras before a run begins.
//
// A draft is trained at a few times of the clip. Between its steps, in rounds, all cameras move towards where the
// draft's images fit theirs (pose_probe.h, pose_solver.h), and later steps see through the moved cameras. The draft is
// then thrown away: its tree was carved while the cameras were wrong, and keeps traces of that.
#pragma once

#include <functional>
#include <optional>

#include "training/train.h"

namespace neuvv::training {

struct PoseSearchProgress {
    double fraction = 0, elapsed_s = 0, eta_s = 0;
    uint32_t rounds = 0;        // done so far
    double psnr = 0;            // of the draft's batches since the last report, dB
    double motion_px = 0;       // by how much the poses found so far move images: root of the mean square, pixels
    double last_motion_px = 0;  // by how much the last round moved them
};

// Called about once a second; returns false to stop the search.
using PoseSearchCallback = std::function<bool(const PoseSearchProgress&)>;

// Returns the changes by camera of the data set, or nothing where the callback stopped the search. Shape, seed, losses
// and --refine colour are those of `settings`; of its budget in minutes, the search takes at most a fifth. Cameras
// without an image at the chosen times keep their pose. Throws InputError and RuntimeFailure as train() does.
std::optional<std::vector<PoseChange>> find_poses(const gpu::Device& device, const Dataset& dataset,
                                                  const TrainSettings& settings, const PoseSearchCallback& callback);

}  // namespace neuvv::training
