// Moves the cameras of a data set as one, to where a scene fits their images best. A run that corrects poses finds its
// scene up to a turn, a motion and a scaling, which no training image can show (pose_solver.h), so that held-out
// cameras look past it by that much.
#pragma once

#include <array>
#include <functional>

#include "gpu/device.h"
#include "training/data/dataset.h"
#include "training/rig/camera_pose.h"
#include "voctree/files/clip_index.h"

namespace neuvv::training {

// The seven numbers of a motion of all cameras, in the world's axes: the angles of a rotation about a centre, in
// radians; a shift in metres; the logarithm of the factor of all distances from the centre.
struct RigMotion {
    glm::dvec3 turn{0}, shift{0};
    double log_scale = 0;
};

// The camera after the motion; its focal length stays.
stage::Camera moved(const stage::Camera& camera, const RigMotion& motion, glm::dvec3 centre);

struct RigAlignment {
    RigMotion motion;
    glm::dvec3 centre{0};
    double motion_px = 0;  // by how much the motion moves images: root of the mean square over all cameras
};

// Called with the fraction done; returns false to stop.
using AlignCallback = std::function<bool(double fraction)>;

// Finds the motion of all cameras after which renders of the clip are nearest to the data set's images, by Gauss and
// Newton's method, from up to 16 images of the segment nearest to the clip's centre that shows somebody. The cameras
// stay where they are where no motion is better. Returns what it has found so far where the callback stops it. Throws
// RuntimeFailure, and InputError where no segment that the images show can be read and has leaves. Bound by tracing up
// to 9 × 15 × 16 images.
RigAlignment align_rig(const gpu::Device& device, const voctree::ClipIndex& clip, const Dataset& dataset,
                       const AlignCallback& callback);

}  // namespace neuvv::training
