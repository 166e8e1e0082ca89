// Trainees made of a trainer's motion: other bodies, other places, other speeds, and planted mistakes.
#pragma once

#include "motion/skeleton/skeleton.h"

namespace neuvv::test {

// The clip at `speed` times its rate: 0.9 takes longer.
motion::SkeletonClip at_speed(const motion::SkeletonClip& clip, double speed);
// Another body's motion: bones of `scale` times the length, moved, turned about +Y.
motion::SkeletonClip other_body(const motion::SkeletonClip& clip, double scale, const glm::dvec3& place, double yaw);
// Every position moves by a normal deviation, metres.
motion::SkeletonClip with_noise(const motion::SkeletonClip& clip, double deviation_m, uint32_t seed);

// From first_s to last_s: the arm turned about the shoulder by an angle, across its own plane.
motion::SkeletonClip with_arm_off(const motion::SkeletonClip& clip, motion::Limb arm, double angle_deg, double first_s,
                                  double last_s);
// The leg does what it should `late_s` later, in the frame of the hips.
motion::SkeletonClip with_late_leg(const motion::SkeletonClip& clip, motion::Limb leg, double late_s, double first_s,
                                   double last_s);
// The body is turned to the other side of `ahead` (an angle about +Y, of the line across the hips from +X).
motion::SkeletonClip with_mirrored_turn(const motion::SkeletonClip& clip, double ahead, double first_s, double last_s);

// Where the clip faces on the whole, as with_mirrored_turn wants it.
double facing_of(const motion::SkeletonClip& clip);

}  // namespace neuvv::test
