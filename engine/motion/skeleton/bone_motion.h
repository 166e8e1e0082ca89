// Skeleton clips as bones that turn: what files of armatures are made of. The rest pose is that of the first frame,
// without rotations.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

using Positions = std::array<glm::dvec3, kJoints>;  // metres

// Positions of all joints in all frames. A joint that a frame does not know stays where it was, and until it is known
// for the first time it is where it will be then; one that is never known is at its parent.
std::vector<Positions> filled_positions(const SkeletonClip& clip);

// A joint relative to its parent: its position in the parent's axes, and its rotation. Of the pelvis, in the world.
struct BoneTransform {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
};

// The transforms that put the joints of the rest pose where they are `now`. Joints give no twist of a limb about
// itself, so a limb follows its parent but for the least swing that its direction asks for.
std::array<BoneTransform, kJoints> bone_transforms(const Positions& rest, const Positions& now);

// The least rotation from one direction to another; identity where one of them has no length.
glm::dquat swing(glm::dvec3 from, glm::dvec3 to);

}  // namespace neuvv::motion
