// Inside of the gizmo only: where its handles are in the world.
#pragma once

#include <array>

#include "tools/viewer/tools/gizmo.h"

namespace neuvv::viewer {

constexpr double kRingAround = 1.25;                    // radius of the ring around all, in sizes
constexpr double kSquareNear = 0.35, kSquareFar = 0.6;  // of the squares between axes

struct GizmoFrame {
    glm::dvec3 middle;               // world
    std::array<glm::dvec3, 3> axes;  // unit, world; at right angles but where the node is sheared
    double size_m;                   // an axis's length
    glm::dvec3 to_eye;               // unit
};

// Nothing where the node is not in front of the camera, or not finite.
std::optional<GizmoFrame> gizmo_frame(const Gizmo& gizmo);

inline glm::dvec3 square_normal(const GizmoFrame& frame, size_t axis) {
    return glm::normalize(glm::cross(frame.axes[(axis + 1) % 3], frame.axes[(axis + 2) % 3]));
}

// A ring's point that is nearest to the eye, as a direction from the middle, and the direction in which the ring goes
// on there, counter-clockwise about its axis.
struct RingFront {
    glm::dvec3 front, onward;
    double facing;  // sine of the angle between the line of sight and the ring's plane
};
RingFront ring_front(const GizmoFrame& frame, glm::dvec3 axis);

}  // namespace neuvv::viewer
