// The motion of an animated glTF model as a skeleton clip: the truth that extraction is measured against.
#pragma once

#include <cstdint>

#include "motion/skeleton/skeleton.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::motion {

// The pose at each time. `animation` as in stage::pose_scene. Throws InputError where the model has no humanoid
// (joint_sources).
SkeletonClip model_motion(const stage::GltfScene& scene, int32_t animation, const std::vector<double>& times_s,
                          double fps);

}  // namespace neuvv::motion
