// A body of which only head, hands and worn trackers are known.
#pragma once

#include <array>
#include <optional>

#include "motion/skeleton/skeleton.h"
#include "xr/bindings.h"
#include "xr/hand_tracking.h"
#include "xr/hands.h"

namespace neuvv::xr {

// The positions of worn trackers, in the order of kTrackerRoles; empty where there is none, or it is not tracked.
using TrackerPositions = std::array<std::optional<glm::dvec3>, kTrackers>;

// All in one space, in metres, +Y up.
struct BodyPoints {
    std::optional<Pose> head;  // between the eyes, looking along −Z
    std::array<std::optional<glm::dvec3>, kHands> wrists;
    TrackerPositions trackers;
};

// The wrist of a hand: the joint of a bare hand, else 7 cm behind the grip pose, whose origin is the centre of the palm
// and whose +Y leads from the knuckles to the wrist. Empty where neither is tracked.
std::optional<glm::dvec3> wrist_of(const HandInput& input, const HandJoints& joints);

// The tip of the nose of a head.
glm::dvec3 nose_of(const Pose& head);

// The pose of the body, or nothing where no point is known. Nose, wrists and joints with a tracker are measured. A
// tracker is worn on the skin, beside the joint: its confidence is 0.8. The neck is the centre of both shoulders where
// both have trackers. Otherwise neck, shoulders and, with a tracker at the waist, hips are placed by an adult's
// proportions, with a confidence of 0.2: they are estimated. All else is unknown. Points that are not within 1000 m of
// the origin count as unknown.
std::optional<motion::Pose> pose_of_points(const BodyPoints& points);

}  // namespace neuvv::xr
