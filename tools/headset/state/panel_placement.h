// Where the panel is, and where it opens; which way panels and labels face.
#pragma once

#include <optional>
#include <utility>

#include "xr/pose.h"

namespace neuvv::headset {

constexpr glm::dvec2 kWristPanel_m{0.24, 0.32};
constexpr double kPanelAspect = 0.75;  // width / height

struct PanelPlacement {
    xr::Pose world_from_panel;  // the origin is the panel's centre; X to its right, Y to its top
    glm::dvec2 size_m = kWristPanel_m;

    // The world position of a point of the panel, which is given as 0..1 from the upper left.
    glm::dvec3 point_at(glm::dvec2 uv) const {
        return world_from_panel * glm::dvec3((uv.x - 0.5) * size_m.x, (0.5 - uv.y) * size_m.y, 0);
    }
};

// A box whose corners are `low` and `high` in the space of `world_from_box`.
struct PlacedBox {
    glm::dmat4 world_from_box{1};
    glm::dvec3 low{0}, high{0};
};

// The panel's centre opens at most kPanelAside_rad beside the direction in which the head looks, at its height and
// facing it. Its width is kPanelWidth_rad.
//
// Where the box `about` is in view, the panel opens beside it (seen_between), on the side with more room. Where there
// is too little room for the panel beside it, the panel is narrower, but not narrower than kMinPanelWidth_rad, at which
// its text can still be read (PanelSurface). So a box that reaches more than 4° to both sides of the view's centre is
// partly covered: as much of it as lies more than 5° to one side. Without a box the panel opens to the left, or to the
// right for `left_handed` users, out of the way of the ray of the hand that points.
//
// `aside_rad` is more for somebody who should be seen whole, such as a trainer: kTrainerAside_rad.
constexpr double kPanelAside_rad = glm::radians(18.25), kTrainerAside_rad = glm::radians(36.0),
                 kPanelWidth_rad = glm::radians(32.0), kMinPanelWidth_rad = glm::radians(26.5);
// From the head to the panel's centre: where eyes accommodate in most headsets, and within reach of both hands' rays.
constexpr double kPanelAway_m = 1.1;
PanelPlacement panel_in_view(const xr::Pose& world_head, const std::optional<PlacedBox>& about, bool left_handed,
                             double aside_rad = kPanelAside_rad);

// The rotation of somebody who looks along `direction`, a unit vector, and does not tilt the head. What has it is seen
// upright and from its front by somebody who looks along `direction` at it.
glm::dquat upright_towards(glm::dvec3 direction);

// The angles to the left of where the head looks between which somebody in the box is seen, least first; nullopt where
// the box is not in view, or reaches behind the head. Bodies do not fill the corners of their boxes, so what counts is
// the upright elliptic cylinder in the box.
std::optional<std::pair<double, double>> seen_between(const xr::Pose& world_head, const PlacedBox& box);

}  // namespace neuvv::headset
