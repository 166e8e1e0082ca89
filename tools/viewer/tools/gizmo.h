// The gizmo of a node: handles in the image by which the node is moved, rotated and scaled. Pure geometry: gizmo_shapes
// is what to draw, gizmo_handle_at what is under the pointer, and dragged the result of a drag.
//
//   move    three arrows, three squares in the planes between them, and a square in the plane of the image
//   rotate  three rings, each only with its half towards the eye, and an outer ring in the plane of the image
//   scale   three lines with squares at their ends, and an outer ring that scales all three axes
//
// Handles that would be seen end on or edge on are left out. Where the node is not in front of the camera, all are.
#pragma once

#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

enum class GizmoMode { kMove, kRotate, kScale };
enum class GizmoAxes { kWorld, kLocal };

// The values of HandleShape::handle. kCentre is the handle in the plane of the image: the square that moves, the outer
// ring that rotates, or the one that scales all axes.
enum class GizmoHandle : int { kNone, kX, kY, kZ, kYZ, kZX, kXY, kCentre };

struct Gizmo {
    stage::Camera camera;
    glm::dmat4 world_from_node{1};  // affine; the node's current transform
    GizmoMode mode = GizmoMode::kMove;
    GizmoAxes axes = GizmoAxes::kWorld;  // kScale always uses the node's axes: others would shear it
    double size_px = 90;                 // the length of an axis that lies in the plane of the image
};

// The shapes to draw, the farthest first. X is red, Y green, Z blue; a square in a plane has the colour of the axis
// that the plane does not contain.
std::vector<HandleShape> gizmo_shapes(const Gizmo& gizmo);
// The handle under the pointer (pixels of the image), as handle_at selects it.
GizmoHandle gizmo_handle_at(const Gizmo& gizmo, glm::dvec2 pointer);

// The `world_from_node` that results when a handle is grabbed at `from` and dragged to `to` (pixels of the image).
// `grabbed` is the gizmo at the time when it was grabbed, so that a drag back to `from` restores exactly the transform
// of that time, and no error accumulates.
//
// Move: by the difference of the two points on the axis that appear nearest to the pointers, or of the points in the
// plane under the pointers. Rotate: about the ring's axis, by the angle between the points in the ring's plane under
// the pointers; where that plane is seen nearly edge on, by the length along the tangent of the ring's front. Scale:
// along the axis, by the ratio of the distances from the centre, but never by less than kMinFactor.
//
// `snap`: moves are multiples of 0.1 m along the axes, angles of 15°, factors of 0.1.
constexpr double kMoveSnap_m = 0.1, kRotateSnap_deg = 15, kScaleSnap = 0.1, kMinFactor = 1e-3;
glm::dmat4 dragged(const Gizmo& grabbed, GizmoHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap);

// The transform of a node in the space of its parent, from the transforms of both in the world. Nullopt where the
// parent's transform is flat or not finite.
std::optional<glm::dmat4> parent_from_node(const glm::dmat4& world_from_parent, const glm::dmat4& world_from_node);

}  // namespace neuvv::viewer
