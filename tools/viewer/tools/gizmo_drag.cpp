#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tools/viewer/tools/gizmo.h"
#include "tools/viewer/tools/gizmo_frame.h"

namespace neuvv::viewer {

namespace {

// RingFront::facing below which a ring is rotated by the length along its front.
constexpr double kEdgeOnRing = 0.15;
// The least distance from the centre by which a ratio divides, in sizes of the gizmo and in pixels.
constexpr double kMinGrip = 0.1, kMinGrip_px = 8;

struct Grabbed {
    const Gizmo& gizmo;
    const GizmoFrame& frame;
    glm::dvec2 from, to;
    bool snap;
};

// The components of `v` along `a` and `b`, in whose plane it lies. The two need not be at right angles.
glm::dvec2 components(glm::dvec3 v, glm::dvec3 a, glm::dvec3 b) {
    const glm::dvec3 normal = glm::cross(a, b), beside_a = glm::cross(normal, a), beside_b = glm::cross(normal, b);
    return {glm::dot(v, beside_b) / glm::dot(a, beside_b), glm::dot(v, beside_a) / glm::dot(b, beside_a)};
}

glm::dvec3 move_along(const Grabbed& grabbed, glm::dvec3 axis) {
    const stage::Camera& camera = grabbed.gizmo.camera;
    const GizmoFrame& frame = grabbed.frame;
    const std::optional<double> from = editor::line_drag(camera, frame.centre, axis, frame.size_m, grabbed.from),
                                to = editor::line_drag(camera, frame.centre, axis, frame.size_m, grabbed.to);
    return from && to ? axis * editor::snapped(*to - *from, kMoveSnap_m, grabbed.snap) : glm::dvec3(0);
}

glm::dvec3 move_in_plane(const Grabbed& grabbed, glm::dvec3 u, glm::dvec3 v) {
    const glm::dvec3 normal = glm::cross(u, v), centre = grabbed.frame.centre;
    const std::optional<glm::dvec3> from = editor::plane_drag(grabbed.gizmo.camera, centre, normal, grabbed.from),
                                    to = editor::plane_drag(grabbed.gizmo.camera, centre, normal, grabbed.to);
    if (!from || !to) return glm::dvec3(0);
    if (!grabbed.snap) return *to - *from;
    const glm::dvec2 move = components(*to - *from, u, v);
    return u * editor::snapped(move.x, kMoveSnap_m, true) + v * editor::snapped(move.y, kMoveSnap_m, true);
}

double angle_about(const Grabbed& grabbed, glm::dvec3 axis) {
    const stage::Camera& camera = grabbed.gizmo.camera;
    const glm::dvec3 centre = grabbed.frame.centre;
    const RingFront ring = ring_front(grabbed.frame, axis);
    if (ring.facing < kEdgeOnRing) {
        const double radius = grabbed.frame.size_m;
        const auto along = [&](glm::dvec2 pointer) {
            return editor::line_drag(camera, centre + ring.front * radius, ring.tangent * radius, 1, pointer);
        };
        const std::optional<double> from = along(grabbed.from), to = along(grabbed.to);
        return from && to ? *to - *from : 0;
    }
    const std::optional<glm::dvec3> from = editor::plane_drag(camera, centre, axis, grabbed.from),
                                    to = editor::plane_drag(camera, centre, axis, grabbed.to);
    if (!from || !to) return 0;
    const glm::dvec3 a = *from - centre, b = *to - centre;
    return std::atan2(glm::dot(axis, glm::cross(a, b)), glm::dot(a, b));
}

double factor_of(double from, double to, double min_grip, bool snap) {
    const double factor = 1 + (to - from) / std::max(from, min_grip);
    return snap ? std::max(editor::snapped(factor, kScaleSnap, true), kScaleSnap) : std::max(factor, kMinFactor);
}

double factor_along(const Grabbed& grabbed, glm::dvec3 axis) {
    const GizmoFrame& frame = grabbed.frame;
    const auto along = [&](glm::dvec2 pointer) {
        return editor::line_drag(grabbed.gizmo.camera, frame.centre, axis * frame.size_m, 1, pointer);
    };
    const std::optional<double> from = along(grabbed.from), to = along(grabbed.to);
    return from && to ? factor_of(*from, *to, kMinGrip, grabbed.snap) : 1;
}

double uniform_factor(const Grabbed& grabbed) {
    const std::optional<glm::dvec2> centre = editor::pixel_of(grabbed.gizmo.camera, grabbed.frame.centre);
    if (!centre) return 1;
    return factor_of(glm::distance(grabbed.from, *centre), glm::distance(grabbed.to, *centre), kMinGrip_px,
                     grabbed.snap);
}

glm::dmat4 moved(const Grabbed& grabbed, GizmoHandle handle) {
    const std::array<glm::dvec3, 3>& axes = grabbed.frame.axes;
    glm::dvec3 move;
    switch (handle) {
        case GizmoHandle::kX:
            move = move_along(grabbed, axes[0]);
            break;
        case GizmoHandle::kY:
            move = move_along(grabbed, axes[1]);
            break;
        case GizmoHandle::kZ:
            move = move_along(grabbed, axes[2]);
            break;
        case GizmoHandle::kYZ:
            move = move_in_plane(grabbed, axes[1], axes[2]);
            break;
        case GizmoHandle::kZX:
            move = move_in_plane(grabbed, axes[2], axes[0]);
            break;
        case GizmoHandle::kXY:
            move = move_in_plane(grabbed, axes[0], axes[1]);
            break;
        default: {
            const glm::dmat4& camera = grabbed.gizmo.camera.world_from_camera;
            move = move_in_plane(grabbed, camera[0], camera[1]);
        }
    }
    glm::dmat4 matrix = grabbed.gizmo.world_from_node;
    matrix[3] += glm::dvec4(move, 0);
    return matrix;
}

// The index of the axis that a handle belongs to; nullopt for handles of planes and for the centre.
std::optional<size_t> axis_of(GizmoHandle handle) {
    if (handle < GizmoHandle::kX || handle > GizmoHandle::kZ) return std::nullopt;
    return static_cast<size_t>(handle) - static_cast<size_t>(GizmoHandle::kX);
}

glm::dmat4 rotated(const Grabbed& grabbed, GizmoHandle handle) {
    const std::optional<size_t> of = axis_of(handle);
    const glm::dvec3 axis = of ? grabbed.frame.axes[*of] : grabbed.frame.to_eye;
    constexpr double kStep = kRotateSnap_deg * std::numbers::pi / 180;
    const double angle = editor::snapped(angle_about(grabbed, axis), kStep, grabbed.snap);
    const glm::dmat4& start = grabbed.gizmo.world_from_node;
    glm::dmat4 matrix = glm::rotate(glm::dmat4(1), angle, axis) * start;
    matrix[3] = start[3];
    return matrix;
}

glm::dmat4 scaled(const Grabbed& grabbed, GizmoHandle handle) {
    const std::optional<size_t> of = axis_of(handle);
    const double factor = of ? factor_along(grabbed, grabbed.frame.axes[*of]) : uniform_factor(grabbed);
    glm::dmat4 matrix = grabbed.gizmo.world_from_node;
    for (int i = 0; i < 3; ++i)
        if (!of || static_cast<size_t>(i) == *of) matrix[i] *= factor;
    return matrix;
}

}  // namespace

glm::dmat4 dragged(const Gizmo& gizmo, GizmoHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap) {
    const std::optional<GizmoFrame> frame = gizmo_frame(gizmo);
    if (!frame || handle == GizmoHandle::kNone || !editor::is_valid_pointer(from) || !editor::is_valid_pointer(to))
        return gizmo.world_from_node;
    const Grabbed grabbed{gizmo, *frame, from, to, snap};
    switch (gizmo.mode) {
        case GizmoMode::kMove:
            return moved(grabbed, handle);
        case GizmoMode::kRotate:
            return rotated(grabbed, handle);
        default:
            return scaled(grabbed, handle);
    }
}

}  // namespace neuvv::viewer
