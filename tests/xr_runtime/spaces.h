// Locating spaces. `world` is STAGE as it was before any recentring: the space of the script's poses.
#pragma once

#include "state.h"

namespace neuvv::xr_runtime {

struct Located {
    XrPosef pose = {{0, 0, 0, 1}, {0, 0, 0}};
    bool is_valid = true;
};

Located head_in_world(XrTime time);
Located hand_in_world(Hand hand, bool is_aim, XrTime time);
Located space_in_world(const Space& space, XrTime time);
Located locate(const Space& space, const Space& base, XrTime time);
// The pose of an eye, which looks along its -Z, in a space.
Located view_in(const Space& space, uint32_t view, XrTime time);
// The eyes' gaze.
Located gaze_in_world(XrTime time);
// The field of view of a view. A narrow view that follows the gaze is as large as one that does not, around where the
// eyes look at this time.
XrFovf fov_of(uint32_t view, XrTime time, bool follows_gaze);

// The hand that a path like /user/hand/left/input/grip/pose belongs to.
Hand hand_of(const std::string& path);

}  // namespace neuvv::xr_runtime
