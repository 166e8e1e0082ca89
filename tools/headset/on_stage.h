// The stage that is watched and edited in a headset, on the host, and its user: where they stand, which tool and
// settings their hands have. No OpenXR and no device here: what hands do to it is the same in a test.
#pragma once

#include "editor/stage_state.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

enum class HandTool { kArrange, kPaint, kRegion };

struct Comfort {
    bool smooth_walk = false;  // else teleports
    bool smooth_turn = false;  // else snaps
    double snap_deg = 30, turn_deg_per_s = 90, walk_m_per_s = 1.6;
    bool vignette = true;
};

constexpr double kLeastBrush_m = 0.01, kLargestBrush_m = 0.4, kLeastBrushOpacity = 0.05;
struct HandBrush {
    enum class Tip { kBall, kBox } tip = Tip::kBall;
    enum class Does { kPaint, kErase } does = Does::kPaint;
    double radius_m = 0.06;               // world; half of a box's edge
    glm::vec3 colour{0.9f, 0.25f, 0.1f};  // sRGB, as wheels show it
    double opacity = 1;
    bool whole_clip = true;  // else as it is at this time, while the surface stays
};

// The state of the stage, and the user who stands in it.
struct OnStage : editor::StageState {
    xr::XrRig rig;
    double floor_m = 0;  // world: where the user and performers stand
    HandTool tool = HandTool::kArrange;
    Comfort comfort;
    HandBrush brush;
    bool panel_shown = false, panel_on_wrist = false;
};

// Where a user first stands: where the stage's first camera does, but upright on the floor; without one, in front of
// its performers. `head` in the tracking space.
xr::XrRig first_rig(const OnStage& on, const xr::Pose& head);

}  // namespace neuvv::headset
