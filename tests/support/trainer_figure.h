// A figure to train with: a body that stands still with its arms spread, in the unit box, as a skeleton and as leaves
// around its bones.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "coach/body.h"
#include "voctree/voctree.h"

namespace neuvv::test {

// It faces +Z, so its left is at +X; its height is 0.95.
inline motion::Pose standing_pose() {
    using enum motion::Joint;
    motion::Pose pose;
    const auto place = [&](motion::Joint joint, const glm::dvec3& at) {
        motion::at(pose, joint) = {at, 1, true};
        const motion::Joint other = motion::info_of(joint).mirrored;
        motion::at(pose, other) = {{other == joint ? at.x : 1 - at.x, at.y, at.z}, 1, true};
    };
    place(kPelvis, {0.5, 0.5, 0.5});
    place(kNeck, {0.5, 0.78, 0.5});
    place(kNose, {0.5, 0.88, 0.56});
    place(kLeftShoulder, {0.59, 0.77, 0.5});
    place(kLeftElbow, {0.73, 0.7, 0.5});
    place(kLeftWrist, {0.87, 0.63, 0.5});
    place(kLeftHip, {0.55, 0.49, 0.5});
    place(kLeftKnee, {0.57, 0.28, 0.5});
    place(kLeftAnkle, {0.58, 0.07, 0.5});
    place(kLeftHeel, {0.58, 0.03, 0.47});
    place(kLeftBigToe, {0.57, 0.03, 0.58});
    place(kLeftSmallToe, {0.61, 0.03, 0.57});
    return pose;
}

// The same with the left arm raised by an angle.
inline motion::Pose pose_with_arm_raised(double angle_deg) {
    using enum motion::Joint;
    motion::Pose pose = standing_pose();
    const glm::dvec3 shoulder = motion::at(pose, kLeftShoulder).position;
    const auto turn = glm::dmat3(glm::rotate(glm::dmat4(1), glm::radians(angle_deg), glm::dvec3(0, 0, 1)));
    for (const motion::Joint joint : {kLeftElbow, kLeftWrist}) {
        glm::dvec3& at = motion::at(pose, joint).position;
        at = shoulder + turn * (at - shoulder);
    }
    return pose;
}

inline motion::SkeletonClip still_clip(const motion::Pose& pose, size_t frames) {
    return {25, std::vector<motion::Pose>(frames, pose)};
}

inline double distance_to(const render::Bone& bone, const glm::dvec3& at) {
    const glm::dvec3 from(bone.from), along = glm::dvec3(bone.to) - from;
    const double share = glm::dot(at - from, along) / std::max(1e-9, glm::dot(along, along));
    return glm::distance(at, from + std::clamp(share, 0.0, 1.0) * along);
}

// Grey leaves around the bones of standing_pose(), which stay as they are for so many frames.
inline voctree::VOctree standing_tree(uint32_t frames) {
    constexpr uint32_t kDepth = 6, kSide = 1u << kDepth, kBases = 1;
    voctree::VOctree tree;
    tree.node_levels = kDepth / 2;
    tree.frames = frames;
    tree.bases = kBases;
    tree.hh_degree = 1;
    tree.sigma_basis.assign(frames, 1);
    tree.gamma_basis.assign(frames, 0);
    const std::vector<coach::BodyBone> body = coach::body_of(standing_pose(), 0.95);
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < kSide * kSide * kSide; ++i) {
        const voctree::LeafPosition position{i % kSide, i / kSide % kSide, i / kSide / kSide, kDepth};
        const glm::dvec3 centre = (glm::dvec3(position.x, position.y, position.z) + 0.5) / double{kSide};
        if (std::ranges::any_of(body, [&](const coach::BodyBone& each) {
                return distance_to(each.bone, centre) < static_cast<double>(each.bone.radius);
            }))
            positions.push_back(position);
    }
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        weights[0] = 250;
        // γ = π/2: the functions of R_00 = √(2/π) give the mean colour, those of R_11 shading from one side (+x, +y).
        for (uint32_t c = 0; c < 3; ++c) {
            float* hh = weights + 2 * kBases + c * hh_count(1);
            hh[2] = hh[4] = -0.7f;
        }
    }
    return tree;
}

}  // namespace neuvv::test
