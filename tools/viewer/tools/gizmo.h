// The gizmo of a node: handles in the image by which it is moved, turned and scaled. Pure geometry: who draws takes
// gizmo_shapes, who has a pointer asks handle_at (handle_shape.h) and dragged.
//
//   move    three arrows, three squares in the planes between them, and a square in the image's plane
//   rotate  three rings, of which the half towards the eye is there, and one around all in the image's plane
//   scale   three lines with squares at their ends, and a ring for all three together
//
// Handles that would be seen end on or edge on are not there. Nothing is, where the node is not in front of the camera.
#pragma once

#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

enum class GizmoMode { kMove, kRotate, kScale };
enum class GizmoAxes { kWorld, kLocal };

// kCentre: the image's plane, the ring around all, all three together. As HandleShape::handle.
enum class GizmoHandle : int { kNone, kX, kY, kZ, kYZ, kZX, kXY, kCentre };

struct Gizmo {
    stage::Camera camera;
    glm::dmat4 world_from_node{1};  // affine, as it is now
    GizmoMode mode = GizmoMode::kMove;
    GizmoAxes axes = GizmoAxes::kWorld;  // of kScale: always the node's own, for others would shear it
    double size_px = 90;                 // an axis's length where it lies in the image's plane
};

// The farthest first. X red, Y green, Z blue; a square has the colour of the axis that it stands across.
std::vector<HandleShape> gizmo_shapes(const Gizmo& gizmo);
GizmoHandle gizmo_handle_at(const Gizmo& gizmo, glm::dvec2 pointer);

// `world_from_node` after a handle was grabbed at `from` and dragged to `to`. The gizmo stays as it was when it was
// grabbed, so that a drag back to `from` gives back exactly what there was, and no error gathers.
//
// Move: by the way on the axis (seen nearest to the pointer) or in the plane (under the pointer). Rotate: about the
// ring's axis by the angle between the pointer's places in the ring's plane; where that is nearly edge on, by the way
// along the ring's front. Scale: along the axis, by the ratio of the distances from the middle; never to less than
// kLeastFactor of what there was.
//
// `snap`: ways in multiples of 0.1 m along the axes, angles of 15°, factors of 0.1.
constexpr double kMoveSnap_m = 0.1, kRotateSnap_deg = 15, kScaleSnap = 0.1, kLeastFactor = 1e-3;
glm::dmat4 dragged(const Gizmo& grabbed, GizmoHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap);

// A node's transform in the space of its parent, from where both shall stand in the world. Nothing where the parent is
// flat or not finite.
std::optional<glm::dmat4> parent_from_node(const glm::dmat4& world_from_parent, const glm::dmat4& world_from_node);

}  // namespace neuvv::viewer
