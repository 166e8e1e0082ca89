#include "tools/viewer/tools/gizmo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stage/stage.h"
#include "tools/viewer/tools/gizmo_frame.h"

namespace neuvv::viewer {

namespace {

using std::numbers::pi;
// The longest axis, in depths of the node: no handle may lie behind the camera.
constexpr double kMaxDepthShare = 0.5;
constexpr double kFlat = 1e-3;        // the least volume that three unit axes must span
constexpr double kFaceOnRing = 0.98;  // RingFront::facing above which the whole ring is drawn
constexpr double kShaftFrom = 0.15;   // where an axis begins, in sizes of the gizmo
constexpr double kHeadLength_px = 13, kHeadWidth_px = 5, kBox_px = 5, kCentre_px = 7;
constexpr double kSquareOpacity = 0.5;

glm::vec4 colour_of(size_t axis, double opacity) {
    constexpr glm::vec3 kColours[] = {{0.92f, 0.26f, 0.28f}, {0.45f, 0.78f, 0.2f}, {0.25f, 0.52f, 0.95f}};
    return {kColours[axis], static_cast<float>(opacity)};
}
const glm::vec4 kWhite(1, 1, 1, 0.9f);

struct GizmoShapes {
    const Gizmo& gizmo;
    const GizmoFrame& frame;
    ShapeView view;
    std::vector<HandleShape> all;

    GizmoShapes(const Gizmo& of, const GizmoFrame& in) : gizmo(of), frame(in), view(of.camera, in.centre, in.size_m) {
        all.reserve(12);
    }
    void add(const std::optional<HandleShape>& shape) {
        if (shape) all.push_back(*shape);
    }
    static int first(size_t axis) { return static_cast<int>(GizmoHandle::kX) + static_cast<int>(axis); }
    static int across(size_t axis) { return static_cast<int>(GizmoHandle::kYZ) + static_cast<int>(axis); }

    void add_axis(size_t axis, bool arrow) {
        const glm::dvec3 axis_m = frame.axes[axis] * frame.size_m, tip = frame.centre + axis_m;
        if (!editor::line_drag(gizmo.camera, frame.centre, axis_m, 1, {0, 0})) return;
        const glm::vec4 colour = colour_of(axis, 1);
        const glm::dvec3 ends[] = {frame.centre + kShaftFrom * axis_m, tip};
        const std::optional<HandleShape> shaft = line_shape(view, first(axis), colour, ends);
        add(shaft);
        if (!arrow) return add(square_shape(view, first(axis), colour, tip, kBox_px));
        if (!shaft) return;
        const glm::dvec3 at = shaft->points[1];
        const glm::dvec2 along = glm::normalize(glm::dvec2(at) - glm::dvec2(shaft->points[0]));
        HandleShape head{first(axis), colour, true, 3};
        head.points[0] = at + glm::dvec3(along * kHeadLength_px, 0);
        head.points[1] = at + glm::dvec3(-along.y, along.x, 0) * kHeadWidth_px;
        head.points[2] = at - glm::dvec3(-along.y, along.x, 0) * kHeadWidth_px;
        add(head);
    }
    void add_square(size_t axis) {
        if (std::abs(glm::dot(square_normal(frame, axis), frame.to_eye)) < editor::kEdgeOn) return;
        const glm::dvec3 u = frame.axes[(axis + 1) % 3] * frame.size_m, v = frame.axes[(axis + 2) % 3] * frame.size_m;
        const glm::dvec3 corners[] = {
            frame.centre + kSquareNear * u + kSquareNear * v, frame.centre + kSquareFar * u + kSquareNear * v,
            frame.centre + kSquareFar * u + kSquareFar * v, frame.centre + kSquareNear * u + kSquareFar * v};
        add(polygon_shape(view, across(axis), colour_of(axis, kSquareOpacity), corners));
    }
    void add_ring(size_t axis) {
        const RingFront ring = ring_front(frame, frame.axes[axis]);
        const double half_angle = ring.facing > kFaceOnRing ? pi : pi / 2;
        add(line_shape(view, first(axis), colour_of(axis, 1),
                       arc(frame.centre, ring.front, ring.tangent, frame.size_m, half_angle)));
    }
    void add_outer_ring() {
        const glm::dvec3 u = editor::perpendicular_to(frame.to_eye);
        add(line_shape(view, static_cast<int>(GizmoHandle::kCentre), kWhite,
                       arc(frame.centre, u, glm::cross(frame.to_eye, u), kOuterRing * frame.size_m, pi)));
    }
};

bool is_finite(const glm::dmat4& matrix) {
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            if (!std::isfinite(matrix[i][k])) return false;
    return true;
}

}  // namespace

std::optional<GizmoFrame> gizmo_frame(const Gizmo& gizmo) {
    if (!is_finite(gizmo.world_from_node)) return std::nullopt;
    GizmoFrame frame{glm::dvec3(gizmo.world_from_node[3]),
                     {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}};
    const double depth = editor::depth_of(gizmo.camera, frame.centre);
    if (!(depth >= editor::kMinDepth_m)) return std::nullopt;
    frame.size_m =
        std::min(editor::metres_of_pixels(gizmo.camera, frame.centre, gizmo.size_px), kMaxDepthShare * depth);
    frame.to_eye = glm::normalize(glm::dvec3(gizmo.camera.world_from_camera[3]) - frame.centre);
    if (gizmo.axes == GizmoAxes::kWorld && gizmo.mode != GizmoMode::kScale) return frame;
    glm::dmat3 local(gizmo.world_from_node);
    for (int i = 0; i < 3; ++i) local[i] /= glm::length(local[i]);
    if (std::abs(glm::determinant(local)) >= kFlat) frame.axes = {local[0], local[1], local[2]};
    return frame;
}

RingFront ring_front(const GizmoFrame& frame, glm::dvec3 axis) {
    const double facing = glm::dot(axis, frame.to_eye);
    const glm::dvec3 front = frame.to_eye - axis * facing;
    const double length = glm::length(front);
    RingFront ring{length > 1e-6 ? front / length : editor::perpendicular_to(axis), {}, std::abs(facing)};
    ring.tangent = glm::cross(axis, ring.front);
    return ring;
}

std::vector<HandleShape> gizmo_shapes(const Gizmo& gizmo) {
    const std::optional<GizmoFrame> frame = gizmo_frame(gizmo);
    if (!frame) return {};
    GizmoShapes shapes(gizmo, *frame);
    for (size_t axis = 0; axis < 3; ++axis) {
        if (gizmo.mode == GizmoMode::kRotate) {
            shapes.add_ring(axis);
            continue;
        }
        shapes.add_axis(axis, gizmo.mode == GizmoMode::kMove);
        if (gizmo.mode == GizmoMode::kMove) shapes.add_square(axis);
    }
    if (gizmo.mode == GizmoMode::kMove)
        shapes.add(
            square_shape(shapes.view, static_cast<int>(GizmoHandle::kCentre), kWhite, frame->centre, kCentre_px));
    else
        shapes.add_outer_ring();
    sort_for_drawing(shapes.all);
    return std::move(shapes.all);
}

GizmoHandle gizmo_handle_at(const Gizmo& gizmo, glm::dvec2 pointer) {
    return static_cast<GizmoHandle>(handle_at(gizmo_shapes(gizmo), pointer));
}

std::optional<glm::dmat4> parent_from_node(const glm::dmat4& world_from_parent, const glm::dmat4& world_from_node) {
    if (!stage::is_valid_transform(world_from_parent)) return std::nullopt;
    glm::dmat4 local = glm::inverse(world_from_parent) * world_from_node;
    for (int i = 0; i < 4; ++i) local[i][3] = i == 3;
    return local;
}

}  // namespace neuvv::viewer
