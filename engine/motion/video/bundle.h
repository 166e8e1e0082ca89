// The fit of a skeleton to the key points of a whole clip: what triangulation of single frames begins, time and bones
// of constant length finish.
#pragma once

#include <vector>

#include "motion/skeleton/skeleton.h"
#include "motion/video/key_points.h"

namespace neuvv::motion {

// Moves the joints of `clip` to the least sum of
//   - reprojection: the distance between each key point and its joint's image, in metres at the joint, over the noise
//     that key points have from frame to frame, weighted by confidence, with a Huber loss, as detectors err far at
//     times;
//   - bones: the difference of each bone from its length, which is one unknown for the clip, over how much it varies in
//     `clip`; the trunk, whose spine bends, is softer;
//   - acceleration: the second difference of each joint over what a body reaches. It and bones count by the second.
// `used` has the key points' flags in the order of `detections.points`, by joint: key points that are swapped,
// contradicted or missing are left out. Joints that no view shows follow their bones and their own motion.
// Joints with confidence 0 in all frames stay as they are. Throws RuntimeFailure where the solver fails.
using UsedPoints = std::vector<std::array<bool, kJoints>>;
void fit_over_time(const Detections& detections, const UsedPoints& used, double height_m, SkeletonClip& clip);

}  // namespace neuvv::motion
