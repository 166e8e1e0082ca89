// A 2D detector that knows the truth: it projects a clip's joints into cameras and errs as real ones do.
#pragma once

#include <cstdint>
#include <string>

#include "motion/skeleton/skeleton.h"
#include "motion/video/key_points.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::test {

// Shares are of key points; swaps of arms or legs of an image.
struct DetectorErrors {
    double noise = 0.01;  // of the body's height, in metres at the joint: the deviation in each direction
    double dropped = 0.15;
    double swapped = 0.05;
    double outliers = 0.03;  // anywhere in the image
};

// Cameras around the clip, alternately low and high, which see all of it.
std::vector<stage::Camera> cameras_around(const motion::SkeletonClip& clip, size_t count);

struct Detected {
    motion::Detections seen;
    size_t swapped = 0;  // arms and legs of images
};
Detected detect_counting(const motion::SkeletonClip& clip, const std::vector<stage::Camera>& cameras,
                         const DetectorErrors& errors, uint32_t seed);
motion::Detections detect(const motion::SkeletonClip& clip, const std::vector<stage::Camera>& cameras,
                          const DetectorErrors& errors, uint32_t seed);

// The motion of an animated model at 25 frames a second, every joint of it measured.
motion::SkeletonClip motion_of(const stage::GltfScene& scene, size_t frames);
motion::SkeletonClip performer_motion(size_t frames);

// Another figure with another motion, by the generator of tools/performer; no frames where there is no python3.
const motion::SkeletonClip& squats_motion();

// The height of a clip's body, metres.
double height_of(const motion::SkeletonClip& clip);

struct ClipError {
    double mean = 0, worst_joint = 0;  // as shares of the truth's height; the latter the mean of the worst joint
    size_t swapped_frames = 0;         // in which a limb is nearer to the truth of its other side
};
ClipError error_of(const motion::SkeletonClip& clip, const motion::SkeletonClip& truth);

}  // namespace neuvv::test
