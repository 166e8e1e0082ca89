// Private to gizmo.cpp and gizmo_drag.cpp: where the handles of a gizmo are in the world.
#pragma once

#include <array>

#include "tools/viewer/tools/gizmo.h"

namespace neuvv::viewer {

constexpr double kOuterRing = 1.25;                     // radius of the outer ring, in sizes of the gizmo
constexpr double kSquareNear = 0.35, kSquareFar = 0.6;  // edges of the squares between axes

struct GizmoFrame {
    glm::dvec3 centre;               // world
    std::array<glm::dvec3, 3> axes;  // unit, world; at right angles unless the node is sheared
    double size_m;                   // the length of an axis
    glm::dvec3 to_eye;               // unit, world
};

// Nullopt where the node is not in front of the camera, or its transform is not finite.
std::optional<GizmoFrame> gizmo_frame(const Gizmo& gizmo);

// The unit normal of the square that stands across an axis.
inline glm::dvec3 square_normal(const GizmoFrame& frame, size_t axis) {
    return glm::normalize(glm::cross(frame.axes[(axis + 1) % 3], frame.axes[(axis + 2) % 3]));
}

// The point of a ring that is nearest to the eye.
struct RingFront {
    glm::dvec3 front;    // unit direction from the centre to that point
    glm::dvec3 tangent;  // unit direction of the ring there, counter-clockwise about its axis
    double facing;       // sine of the angle between the line of sight and the ring's plane
};
RingFront ring_front(const GizmoFrame& frame, glm::dvec3 axis);

}  // namespace neuvv::viewer
