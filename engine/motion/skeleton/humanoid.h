// Finds a person in the named bones of another program's skeleton: glTF, BVH, VRM.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

// A bone at rest: the pose in which the model was bound to its skeleton.
struct RestBone {
    std::string name;
    glm::dmat4 world_from_bone{1};
    std::vector<glm::dvec3> skin;  // world positions of the vertices that follow this bone most; may be empty
};

// A joint as a point that is fixed to a bone, or as the mean of two such points.
struct JointSource {
    struct Point {
        size_t bone = 0;
        glm::dvec3 offset{0};  // in the bone's space
    };
    std::vector<Point> points;  // empty: the skeleton lacks the joint
    bool measured = false;      // false: placed by a body's usual proportions
};
using JointSources = std::array<JointSource, kJoints>;

// Recognises bones by their names (bone_names.h). Nose, heels and toes are found in the skin of head and feet where
// there is some, else at bones of these names, else guessed. Throws InputError, naming `file` and the bones that are
// missing, where there is no head, arm or leg.
JointSources joint_sources(std::span<const RestBone> bones, const std::string& file);

// The pose of the bones' world transforms.
Pose pose_of(const JointSources& sources, std::span<const glm::dmat4> world_from_bones);

}  // namespace neuvv::motion
