#include "tools/viewer/tools/gizmo.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "support/near.h"
#include "tests/viewer/some_eye.h"

namespace neuvv {
namespace {

using std::numbers::pi;
using test::expect_near;

const viewer::GizmoHandle kAxes[] = {viewer::GizmoHandle::kX, viewer::GizmoHandle::kY, viewer::GizmoHandle::kZ};
const viewer::GizmoHandle kPlanes[] = {viewer::GizmoHandle::kYZ, viewer::GizmoHandle::kZX, viewer::GizmoHandle::kXY};

// A node that is rotated, scaled and away from the pivot.
viewer::Gizmo some_gizmo(viewer::GizmoMode mode, viewer::GizmoAxes axes = viewer::GizmoAxes::kWorld) {
    glm::dmat4 world = glm::translate(glm::dmat4(1), glm::dvec3(0.4, 0.7, -0.1));
    world = glm::rotate(world, 0.5, glm::normalize(glm::dvec3(1, 2, 0.3)));
    world = glm::scale(world, glm::dvec3(1.5, 0.5, 2));
    return {test::some_camera(), world, mode, axes};
}

glm::dvec3 position_of(const glm::dmat4& m) {
    return m[3];
}
glm::dvec3 axis_of(const viewer::Gizmo& gizmo, int axis) {
    if (gizmo.axes == viewer::GizmoAxes::kLocal || gizmo.mode == viewer::GizmoMode::kScale)
        return glm::normalize(glm::dvec3(gizmo.world_from_node[axis]));
    glm::dvec3 unit(0);
    unit[axis] = 1;
    return unit;
}
glm::dvec2 pixel_of(const viewer::Gizmo& gizmo, glm::dvec3 world) {
    return editor::pixel_of(gizmo.camera, world).value();
}
double size_m(const viewer::Gizmo& gizmo) {
    return editor::metres_of_pixels(gizmo.camera, position_of(gizmo.world_from_node), gizmo.size_px);
}
bool is_finite(const glm::dmat4& matrix) {
    bool finite = true;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) finite &= std::isfinite(matrix[i][k]);
    return finite;
}
std::set<int> handles_of(const viewer::Gizmo& gizmo) {
    std::set<int> handles;
    for (const viewer::HandleShape& shape : viewer::gizmo_shapes(gizmo)) handles.insert(shape.handle);
    return handles;
}

TEST(Gizmo, HasTheHandlesOfItsMode) {
    EXPECT_EQ(handles_of(some_gizmo(viewer::GizmoMode::kMove)), (std::set<int>{1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(handles_of(some_gizmo(viewer::GizmoMode::kRotate)), (std::set<int>{1, 2, 3, 7}));
    EXPECT_EQ(handles_of(some_gizmo(viewer::GizmoMode::kScale)), (std::set<int>{1, 2, 3, 7}));
}

TEST(Gizmo, IsAsLargeAtAnyDistance) {
    for (const double distance : {0.1, 3.0, 500.0}) {
        viewer::Gizmo gizmo{test::some_camera()};
        const Ray ray = editor::ray_through(gizmo.camera, {320, 240});
        gizmo.world_from_node = glm::translate(glm::dmat4(1), ray.origin + ray.direction * distance);
        // The outer ring has this radius in the image's plane.
        gizmo.mode = viewer::GizmoMode::kRotate;
        double widest = 0;
        for (const viewer::HandleShape& shape : viewer::gizmo_shapes(gizmo))
            for (uint32_t i = 0; i < shape.count; ++i)
                widest = std::max(widest, glm::distance(glm::dvec2(shape.points[i]), glm::dvec2(320, 240)));
        EXPECT_NEAR(widest, 1.25 * gizmo.size_px, 1e-6) << distance;
    }
}

TEST(Gizmo, HandlesAreHitWhereTheyAreSeen) {
    for (const viewer::GizmoAxes axes : {viewer::GizmoAxes::kWorld, viewer::GizmoAxes::kLocal}) {
        const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove, axes);
        const glm::dvec3 centre = position_of(gizmo.world_from_node);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec2 pixel = pixel_of(gizmo, centre + axis_of(gizmo, axis) * size_m(gizmo) * 0.9);
            EXPECT_EQ(viewer::gizmo_handle_at(gizmo, pixel), kAxes[axis]);
            const glm::dvec3 u = axis_of(gizmo, (axis + 1) % 3), v = axis_of(gizmo, (axis + 2) % 3);
            EXPECT_EQ(viewer::gizmo_handle_at(gizmo, pixel_of(gizmo, centre + (u + v) * size_m(gizmo) * 0.5)),
                      kPlanes[axis]);
        }
        EXPECT_EQ(viewer::gizmo_handle_at(gizmo, pixel_of(gizmo, centre)), viewer::GizmoHandle::kCentre);
        EXPECT_EQ(viewer::gizmo_handle_at(gizmo, {5, 5}), viewer::GizmoHandle::kNone);
        EXPECT_EQ(viewer::gizmo_handle_at(gizmo, {-FLT_MAX, -FLT_MAX}), viewer::GizmoHandle::kNone);
    }
}

TEST(Gizmo, RingsAreHitOnTheirFrontHalf) {
    const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kRotate);
    const glm::dvec3 centre = position_of(gizmo.world_from_node);
    const glm::dvec3 to_eye = glm::normalize(glm::dvec3(gizmo.camera.world_from_camera[3]) - centre);
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 along = axis_of(gizmo, axis);
        const glm::dvec3 front = glm::normalize(to_eye - along * glm::dot(to_eye, along));
        const glm::dvec3 side = glm::cross(along, front);
        const glm::dvec3 at = front * std::cos(0.4) + side * std::sin(0.4);
        EXPECT_EQ(viewer::gizmo_handle_at(gizmo, pixel_of(gizmo, centre + at * size_m(gizmo))), kAxes[axis]);
        EXPECT_NE(viewer::gizmo_handle_at(gizmo, pixel_of(gizmo, centre - at * size_m(gizmo))), kAxes[axis]);
    }
}

TEST(Gizmo, HitsAreWithinEightPixels) {
    const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove);
    const glm::dvec3 centre = position_of(gizmo.world_from_node);
    const glm::dvec2 foot = pixel_of(gizmo, centre), tip = pixel_of(gizmo, centre + glm::dvec3(0, size_m(gizmo), 0));
    const glm::dvec2 along = glm::normalize(tip - foot), beside(-along.y, along.x), on = glm::mix(foot, tip, 0.8);
    EXPECT_EQ(viewer::gizmo_handle_at(gizmo, on + 7.5 * beside), viewer::GizmoHandle::kY);
    EXPECT_NE(viewer::gizmo_handle_at(gizmo, on + 8.5 * beside), viewer::GizmoHandle::kY);
}

TEST(Gizmo, TheNearerHandleIsHit) {
    viewer::HandleShape near{1}, far{2};
    near.count = far.count = 2;
    near.points = {glm::dvec3(0, 0, -1), glm::dvec3(100, 0, -1)};
    far.points = {glm::dvec3(0, 1, 1), glm::dvec3(100, 1, 1)};
    for (const auto& shapes : {std::vector{near, far}, std::vector{far, near}}) {
        EXPECT_EQ(viewer::handle_at(shapes, {50, 1}), 1) << "as good as at the same place: the one in front";
        EXPECT_EQ(viewer::handle_at(shapes, {50, 7}), 1);
        EXPECT_EQ(viewer::handle_at(shapes, {50, 8.5}), 2) << "the other is too far";
    }
    far.points[0].y = far.points[1].y = 10;
    EXPECT_EQ(viewer::handle_at(std::vector{near, far}, {50, 9}), 2);
    near.handle = 0;
    EXPECT_EQ(viewer::handle_at(std::vector{near, far}, {50, 0}), 0) << "decoration";
}

TEST(Gizmo, MovesAlongAnAxisExactly) {
    for (const viewer::GizmoAxes axes : {viewer::GizmoAxes::kWorld, viewer::GizmoAxes::kLocal}) {
        const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove, axes);
        const glm::dvec3 centre = position_of(gizmo.world_from_node);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 along = axis_of(gizmo, axis);
            const glm::dvec2 from = pixel_of(gizmo, centre + along * 0.3), to = pixel_of(gizmo, centre - along * 0.43);
            const glm::dmat4 after = viewer::dragged(gizmo, kAxes[axis], from, to, false);
            expect_near(position_of(after), centre - along * 0.73);
            for (int i = 0; i < 3; ++i) EXPECT_EQ(after[i], gizmo.world_from_node[i]);
            expect_near(position_of(viewer::dragged(gizmo, kAxes[axis], from, to, true)), centre - along * 0.7);
            EXPECT_EQ(viewer::dragged(gizmo, kAxes[axis], from, from, false), gizmo.world_from_node);
        }
    }
}

TEST(Gizmo, MovesInAPlaneExactly) {
    for (const viewer::GizmoAxes axes : {viewer::GizmoAxes::kWorld, viewer::GizmoAxes::kLocal}) {
        const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove, axes);
        const glm::dvec3 centre = position_of(gizmo.world_from_node);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 u = axis_of(gizmo, (axis + 1) % 3), v = axis_of(gizmo, (axis + 2) % 3);
            const glm::dvec2 from = pixel_of(gizmo, centre + (u + v) * 0.2);
            const glm::dvec2 to = pixel_of(gizmo, centre + u * 0.53 - v * 0.18);
            expect_near(position_of(viewer::dragged(gizmo, kPlanes[axis], from, to, false)),
                        centre + u * 0.33 - v * 0.38);
            expect_near(position_of(viewer::dragged(gizmo, kPlanes[axis], from, to, true)), centre + u * 0.3 - v * 0.4);
        }
    }
}

TEST(Gizmo, SnapsInThePlaneOfShearedAxes) {
    viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove, viewer::GizmoAxes::kLocal);
    glm::dmat4 shear(1);
    shear[1][0] = 0.6;
    gizmo.world_from_node = gizmo.world_from_node * shear;
    const glm::dvec3 centre = position_of(gizmo.world_from_node), u = axis_of(gizmo, 0), v = axis_of(gizmo, 1);
    const glm::dvec2 from = pixel_of(gizmo, centre), to = pixel_of(gizmo, centre + u * 0.33 - v * 0.18);
    expect_near(position_of(viewer::dragged(gizmo, viewer::GizmoHandle::kXY, from, to, true)),
                centre + u * 0.3 - v * 0.2);
}

TEST(Gizmo, TheCentreFollowsThePointer) {
    const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kMove);
    const glm::dvec3 centre = position_of(gizmo.world_from_node);
    const glm::dvec2 from = pixel_of(gizmo, centre), to(500, 77);
    const glm::dmat4 after = viewer::dragged(gizmo, viewer::GizmoHandle::kCentre, from, to, false);
    EXPECT_LT(glm::distance(pixel_of(gizmo, position_of(after)), to), 1e-9);
    EXPECT_NEAR(editor::depth_of(gizmo.camera, position_of(after)), editor::depth_of(gizmo.camera, centre), 1e-9);
}

TEST(Gizmo, RotatesByTheAngleInTheRing) {
    for (const viewer::GizmoAxes axes : {viewer::GizmoAxes::kWorld, viewer::GizmoAxes::kLocal}) {
        const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kRotate, axes);
        const glm::dvec3 centre = position_of(gizmo.world_from_node);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 along = axis_of(gizmo, axis), u = editor::perpendicular_to(along),
                             v = glm::cross(along, u);
            const auto on_ring = [&](double angle) {
                return pixel_of(gizmo, centre + size_m(gizmo) * (u * std::cos(angle) + v * std::sin(angle)));
            };
            for (const double angle : {0.3, -1.0, 2.9, pi / 2}) {
                const glm::dmat4 after = viewer::dragged(gizmo, kAxes[axis], on_ring(1), on_ring(1 + angle), false);
                glm::dmat4 turned = glm::rotate(glm::dmat4(1), angle, along) * gizmo.world_from_node;
                turned[3] = gizmo.world_from_node[3];
                expect_near(after, turned);
                turned =
                    glm::rotate(glm::dmat4(1), std::round(angle * 12 / pi) * pi / 12, along) * gizmo.world_from_node;
                turned[3] = gizmo.world_from_node[3];
                expect_near(viewer::dragged(gizmo, kAxes[axis], on_ring(1), on_ring(1 + angle), true), turned);
            }
            EXPECT_EQ(viewer::dragged(gizmo, kAxes[axis], on_ring(1), on_ring(1), false), gizmo.world_from_node);
        }
    }
}

TEST(Gizmo, RotatesAsSeenByTheRingAroundAll) {
    viewer::Gizmo gizmo{test::some_camera()};
    gizmo.world_from_node[3] = glm::dvec4(test::some_eye().pivot, 1);
    gizmo.mode = viewer::GizmoMode::kRotate;
    // A quarter turn to the left in the image: the right side goes up.
    const glm::dmat4 after = viewer::dragged(gizmo, viewer::GizmoHandle::kCentre, {420, 240}, {320, 140}, false);
    const glm::dmat3 camera(gizmo.camera.world_from_camera);
    expect_near(glm::dmat3(after) * camera[0], camera[1]);
    expect_near(glm::dmat3(after) * camera[2], camera[2]);
}

TEST(Gizmo, RingsSeenEdgeOnTurnAlongTheirFront) {
    viewer::Gizmo gizmo;
    gizmo.camera = viewer::camera_of(viewer::Eye{.distance = 5}, 640, 480);
    gizmo.mode = viewer::GizmoMode::kRotate;
    const glm::dvec2 from(320, 240), to(320 + 20, 240);
    const glm::dmat4 after = viewer::dragged(gizmo, viewer::GizmoHandle::kY, from, to, false);
    // The front goes to the right: about +Y, by its motion divided by the radius at the front's depth.
    const double radius = size_m(gizmo), move = 20 * (5 - radius) / gizmo.camera.fx;
    expect_near(after, glm::rotate(glm::dmat4(1), move / radius, glm::dvec3(0, 1, 0)));
}

TEST(Gizmo, ScalesByTheRatio) {
    const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kScale);
    const glm::dvec3 centre = position_of(gizmo.world_from_node);
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 along = axis_of(gizmo, axis) * size_m(gizmo);
        for (const double factor : {0.35, 1.0, 1.83}) {
            const glm::dvec2 from = pixel_of(gizmo, centre + along), to = pixel_of(gizmo, centre + along * factor);
            glm::dmat4 expected = gizmo.world_from_node;
            expected[axis] *= factor;
            expect_near(viewer::dragged(gizmo, kAxes[axis], from, to, false), expected);
        }
        const glm::dmat4 snap = viewer::dragged(gizmo, kAxes[axis], pixel_of(gizmo, centre + along),
                                                pixel_of(gizmo, centre + along * 1.83), true);
        EXPECT_NEAR(glm::length(snap[axis]), 1.8 * glm::length(gizmo.world_from_node[axis]), 1e-9);
    }
    const glm::dvec2 foot = pixel_of(gizmo, centre);
    glm::dmat4 half = gizmo.world_from_node;
    for (int i = 0; i < 3; ++i) half[i] *= 0.5;
    expect_near(viewer::dragged(gizmo, viewer::GizmoHandle::kCentre, foot + glm::dvec2(0, 100),
                                foot + glm::dvec2(50, 0), false),
                half);
}

TEST(Gizmo, ScalesNeitherFlatNorMirrored) {
    const viewer::Gizmo gizmo = some_gizmo(viewer::GizmoMode::kScale);
    const glm::dvec3 centre = position_of(gizmo.world_from_node), along = axis_of(gizmo, 0) * size_m(gizmo);
    for (const double to : {0.0, -1.0, -3.0})
        for (const bool snap : {false, true}) {
            const glm::dmat4 after = viewer::dragged(gizmo, viewer::GizmoHandle::kX, pixel_of(gizmo, centre + along),
                                                     pixel_of(gizmo, centre + along * to), snap);
            const double min_factor = snap ? viewer::kScaleSnap : viewer::kMinFactor;
            EXPECT_NEAR(glm::length(after[0]), min_factor * glm::length(gizmo.world_from_node[0]), 1e-9);
            EXPECT_GT(glm::dot(after[0], gizmo.world_from_node[0]), 0);
        }
}

TEST(Gizmo, HandlesSeenEndOnAreNotThere) {
    viewer::Gizmo gizmo;
    gizmo.camera = viewer::camera_of(viewer::Eye{.distance = 5}, 640, 480);  // along −Z
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{1, 2, 6, 7})) << "no Z, no planes along it";
    const glm::dmat4 start = gizmo.world_from_node;
    for (const viewer::GizmoHandle handle :
         {viewer::GizmoHandle::kZ, viewer::GizmoHandle::kYZ, viewer::GizmoHandle::kZX})
        EXPECT_EQ(viewer::dragged(gizmo, handle, {320, 240}, {400, 300}, false), start);
    gizmo.mode = viewer::GizmoMode::kScale;
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{1, 2, 7}));
    EXPECT_EQ(viewer::dragged(gizmo, viewer::GizmoHandle::kZ, {320, 240}, {400, 300}, false), start);
}

// For pointers over the whole image and beyond, and for every handle: the result is finite, and pointers near each
// other give transforms near each other. The views include those along axes.
TEST(Gizmo, DragsHaveNoJumps) {
    for (const viewer::GizmoMode mode :
         {viewer::GizmoMode::kMove, viewer::GizmoMode::kScale, viewer::GizmoMode::kRotate})
        for (const double yaw : {0.0, 0.05, 0.4, pi / 2})
            for (const double pitch : {-pi / 2, -1.4, -0.1, 0.0}) {
                viewer::Gizmo gizmo{
                    viewer::camera_of(viewer::Eye{.yaw = yaw, .pitch = pitch, .distance = 5}, 640, 480)};
                gizmo.mode = mode;
                gizmo.world_from_node[3] = glm::dvec4(0.3, -0.2, 0.1, 1);
                for (int handle = 1; handle <= 7; ++handle)
                    for (const glm::dvec2 direction : {glm::dvec2(1, 0.3), glm::dvec2(-0.2, 1)}) {
                        glm::dmat4 before(0);
                        const glm::dvec2 from(400, 200);
                        for (int i = 0; i <= 3000; ++i) {
                            const glm::dvec2 to = glm::dvec2(310, 230) + direction * ((i - 1500) * 0.5);
                            const glm::dmat4 after =
                                viewer::dragged(gizmo, static_cast<viewer::GizmoHandle>(handle), from, to, false);
                            ASSERT_TRUE(is_finite(after));
                            // A rotation by nearly half a revolution, as the pointer passes the centre, is no jump.
                            if (i > 0 && mode != viewer::GizmoMode::kRotate) {
                                const double farthest = 5 * editor::kMaxDepthFactor;
                                ASSERT_LT(glm::length(after[3]), 2.5 * farthest);
                                ASSERT_LT(glm::length(after[3] - before[3]), 0.2 * farthest)
                                    << handle << " yaw " << yaw << " pitch " << pitch << " at " << i;
                            }
                            before = after;
                        }
                    }
            }
}

TEST(Gizmo, StrangeInputIsHarmless) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const viewer::GizmoMode mode :
         {viewer::GizmoMode::kMove, viewer::GizmoMode::kRotate, viewer::GizmoMode::kScale}) {
        viewer::Gizmo gizmo = some_gizmo(mode, viewer::GizmoAxes::kLocal);
        for (int handle = 0; handle <= 7; ++handle)
            for (const double strange : {nan, -double{FLT_MAX}, 1e300})
                EXPECT_EQ(
                    viewer::dragged(gizmo, static_cast<viewer::GizmoHandle>(handle), {300, 200}, {strange, 3}, true),
                    gizmo.world_from_node);
        for (int i = 0; i < 3; ++i) {
            gizmo.world_from_node[i] = glm::dvec4(0);  // flat
            for (int handle = 0; handle <= 7; ++handle)
                EXPECT_TRUE(is_finite(
                    viewer::dragged(gizmo, static_cast<viewer::GizmoHandle>(handle), {300, 200}, {350, 210}, false)));
            EXPECT_FALSE(viewer::gizmo_shapes(gizmo).empty());
        }
        gizmo.world_from_node[3].x = nan;
        EXPECT_TRUE(viewer::gizmo_shapes(gizmo).empty());
        gizmo.world_from_node[3] = gizmo.camera.world_from_camera[3];
        EXPECT_TRUE(viewer::gizmo_shapes(gizmo).empty()) << "in the eye";
        EXPECT_EQ(viewer::dragged(gizmo, viewer::GizmoHandle::kX, {1, 2}, {3, 4}, false), gizmo.world_from_node);
        gizmo.world_from_node[3] += 2.0 * gizmo.camera.world_from_camera[2];
        EXPECT_TRUE(viewer::gizmo_shapes(gizmo).empty()) << "behind";
    }
}

TEST(Gizmo, PutsNodesIntoTheSpaceOfTheirParents) {
    const glm::dmat4 parent = some_gizmo(viewer::GizmoMode::kMove).world_from_node;
    const glm::dmat4 world = glm::rotate(glm::dmat4(1), 1.0, glm::dvec3(0, 1, 0));
    const std::optional<glm::dmat4> local = viewer::parent_from_node(parent, world);
    ASSERT_TRUE(local);
    expect_near(parent * *local, world, 1e-12);
    for (int i = 0; i < 4; ++i) EXPECT_EQ((*local)[i][3], i == 3 ? 1 : 0);
    EXPECT_FALSE(viewer::parent_from_node(glm::scale(glm::dmat4(1), glm::dvec3(1, 0, 1)), world));
}

}  // namespace
}  // namespace neuvv
