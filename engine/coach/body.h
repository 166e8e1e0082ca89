// The trainer's body as bones with a thickness: what leaves are bound to, and what hides what.
#pragma once

#include <vector>

#include "motion/skeleton/skeleton.h"
#include "render/volume/highlight.h"

namespace neuvv::coach {

using LimbValues = std::array<double, motion::kLimbs>;

struct BodyBone {
    render::Bone bone;  // the space of the pose, metres
    motion::Limb limb = motion::Limb::kTrunk;
};

// The bones of a pose whose two joints are known. Their thickness is a share of the body's height, metres; a head is
// added around the nose.
std::vector<BodyBone> body_of(const motion::Pose& pose, double height);

// The highlight of a body whose limbs are red by 0..1.
render::Highlight highlight_of(const std::vector<BodyBone>& body, const LimbValues& red);

}  // namespace neuvv::coach
