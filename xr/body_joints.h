// The joints of a body as OpenXR's extensions number them, and how they become the joints of a skeleton.
#pragma once

#include <array>
#include <span>

#include "motion/skeleton/skeleton.h"
#include "xr/body_tracking_types.h"

namespace neuvv::xr {

// Where each joint of a skeleton comes from: the mean of two joints of the extension; {n, n}: that joint itself;
// {−1, −1}: the extension lacks it. The nose comes from the headset's own pose.
using BodyJointSources = std::array<std::array<int, 2>, motion::kJoints>;
extern const BodyJointSources kMetaBodySources;  // XR_FB_body_tracking, with and without the joints of the full body
extern const BodyJointSources kBdBodySources;    // XR_BD_body_tracking

// A joint in any space. XrBodyJointLocationFB and XrBodyJointLocationBD have these members.
struct BodyJointLocation {
    XrSpaceLocationFlags flags = 0;
    XrVector3f position = {0, 0, 0};
};

// The pose of a body whose joints the runtime located. `confidence` is the runtime's for the whole body; it is clamped
// to 0..1, and NaN counts as 0. A joint is unknown where its sources are beyond the end of `joints`, have no valid
// position, or are not within 1000 m of the origin. A joint whose position is valid but not tracked was guessed by the
// runtime, as legs are that no camera sees: it is not measured, and has half of the confidence.
motion::Pose pose_of_body(std::span<const BodyJointLocation> joints, const BodyJointSources& sources,
                          double confidence);

// Whether anything is known of the body.
bool has_joints(const motion::Pose& pose);

// Whether a position can be a joint's: finite, and within 1000 m of the origin.
bool is_near(const glm::dvec3& position);

}  // namespace neuvv::xr
