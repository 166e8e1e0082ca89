#include "editor/pointer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/volume/pick.h"
#include "tests/editor/some_camera.h"

namespace neuvv {
namespace {

using test::some_camera;

TEST(Pointer, RaysAreThoseOfPicking) {
    const stage::Camera camera = some_camera();
    for (const glm::dvec2 pixel : {glm::dvec2(0, 0), glm::dvec2(320, 240), glm::dvec2(17.5, 400.25)}) {
        const Ray ray = editor::ray_through(camera, pixel);
        const PickRay picked = render::pick_ray(camera, pixel);
        EXPECT_LT(glm::length(ray.origin - glm::dvec3(picked.origin)), 1e-6);
        EXPECT_LT(glm::length(ray.direction - glm::dvec3(picked.direction)), 1e-6);
    }
}

TEST(Pointer, APointOnARayIsSeenAtItsPixel) {
    const stage::Camera camera = some_camera();
    for (const glm::dvec2 pixel : {glm::dvec2(1, 2), glm::dvec2(320, 240), glm::dvec2(600, 33)})
        for (const double far : {0.1, 2.0, 1000.0}) {
            const Ray ray = editor::ray_through(camera, pixel);
            const std::optional<glm::dvec2> seen = editor::pixel_of(camera, ray.origin + ray.direction * far);
            ASSERT_TRUE(seen);
            EXPECT_LT(glm::distance(*seen, pixel), 1e-8);
            EXPECT_FALSE(editor::pixel_of(camera, ray.origin - ray.direction * far)) << "behind";
        }
    EXPECT_FALSE(editor::pixel_of(camera, camera.world_from_camera[3]));
}

TEST(Pointer, SegmentsEndInFrontOfTheCamera) {
    const stage::Camera camera = some_camera();
    const glm::dvec3 eye = camera.world_from_camera[3], before = editor::ray_through(camera, {100, 200}).direction;
    const glm::dvec3 near = eye + before * 3.0, behind = eye - before * 2.0 + glm::dvec3(0.1, 0, 0);
    const auto whole = editor::pixels_of(camera, near, eye + before * 4.0);
    ASSERT_TRUE(whole);
    EXPECT_LT(glm::distance(whole->first, {100, 200}) + glm::distance(whole->second, {100, 200}), 1e-8);
    const auto cut = editor::pixels_of(camera, near, behind), turned = editor::pixels_of(camera, behind, near);
    ASSERT_TRUE(cut && turned);
    EXPECT_LT(glm::distance(cut->first, {100, 200}), 1e-8);
    EXPECT_LT(glm::distance(cut->second, turned->first), 1e-6) << "either way around";
    EXPECT_TRUE(std::isfinite(cut->second.x) && std::isfinite(cut->second.y));
    EXPECT_FALSE(editor::pixels_of(camera, behind, behind - before));
}

TEST(Pointer, ALengthInPixelsHoldsAtItsDepth) {
    const stage::Camera camera = some_camera();
    const glm::dvec3 at =
        editor::ray_through(camera, {320, 240}).origin + editor::ray_through(camera, {320, 240}).direction * 5.0;
    const glm::dvec3 up = camera.world_from_camera[1];
    const glm::dvec2 tip = *editor::pixel_of(camera, at + up * editor::metres_of_pixels(camera, at, 40));
    EXPECT_LT(glm::distance(tip, {320, 200}), 1e-8);
}

TEST(Pointer, ALineIsDraggedToWhereThePointerIs) {
    const stage::Camera camera = some_camera();
    const glm::dvec3 through(0.1, 0.9, -0.2);
    for (const glm::dvec3 along : {glm::dvec3(1, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(-0.3, 0.2, 0.7)})
        for (const double s : {-0.7, 0.0, 0.3, 1.0}) {
            const glm::dvec2 seen = *editor::pixel_of(camera, through + along * s);
            EXPECT_NEAR(editor::line_drag(camera, through, along, 0.5, seen).value(), s, 1e-9);
            // For a pointer beside the line, the result is the nearest point in the image: the foot of the
            // perpendicular.
            const glm::dvec2 on = *editor::pixel_of(camera, through + along * (s + 0.01)) - seen;
            const glm::dvec2 beside = seen + 30.0 * glm::normalize(glm::dvec2(-on.y, on.x));
            EXPECT_NEAR(editor::line_drag(camera, through, along, 0.5, beside).value(), s, 1e-9);
        }
}

TEST(Pointer, LinesHaveNoJumpWhereTheyVanish) {
    stage::Camera camera = some_camera();
    camera.world_from_camera = glm::dmat4(1);
    const glm::dvec3 through(0, -1, -4), along(0, 0, -1);  // vanishes in the centre of the image
    double before = -1;
    for (double y = 400; y >= 0; y -= 0.01) {
        const double s = editor::line_drag(camera, through, along, 1, {camera.cx, y}).value();
        EXPECT_LE(std::abs(s), 4 * editor::kMaxDepthFactor);
        EXPECT_GE(s, before - 1e-9) << "comes back at " << y;
        before = s;
        if (y < camera.cy) {
            EXPECT_NEAR(s, 4 * (editor::kMaxDepthFactor - 1), 1e-9);
        }
    }
    EXPECT_FALSE(editor::line_drag(camera, {0, 0, -4}, along, 1, {10, 10})) << "end on";
    EXPECT_FALSE(editor::line_drag(camera, {0, 0, 4}, along, 1, {10, 10})) << "behind";
}

TEST(Pointer, APlaneIsDraggedToWhereThePointerIs) {
    const stage::Camera camera = some_camera();
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, 1, 0.1)), through(0, 0.5, 0);
    for (const double sign : {1.0, -1.0})
        for (const glm::dvec2 at : {glm::dvec2(0.3, -0.4), glm::dvec2(-1, 0.2), glm::dvec2(0, 0)}) {
            const glm::dvec3 u = glm::normalize(glm::cross(normal, glm::dvec3(1, 0, 0)));
            const glm::dvec3 point = through + u * at.x + glm::cross(normal, u) * at.y;
            const auto dragged = editor::plane_drag(camera, through, normal * sign, *editor::pixel_of(camera, point));
            ASSERT_TRUE(dragged);
            EXPECT_LT(glm::length(*dragged - point), 1e-9);
        }
}

TEST(Pointer, PlanesHaveNoJumpAtTheirHorizon) {
    stage::Camera camera = some_camera();
    camera.world_from_camera = glm::dmat4(1);
    const glm::dvec3 through(0, -1, -4), normal(0, 1, 0);
    double before = 0;
    for (double y = camera.height; y >= 0; y -= 0.01) {
        const glm::dvec3 point = editor::plane_drag(camera, through, normal, {camera.cx, y}).value();
        EXPECT_NEAR(point.y, -1, 1e-9) << "left the plane at " << y;
        EXPECT_LE(glm::length(point), editor::kMaxDepthFactor * 4.2);
        // Above the horizon the point hardly moves: only as far as the ray turns.
        if (y > camera.cy + 3) {
            EXPECT_LE(point.z, before + 1e-9);
        } else if (y < camera.cy) {
            EXPECT_LT(std::abs(point.z - before), 0.1);
        }
        before = point.z;
    }
    EXPECT_FALSE(editor::plane_drag(camera, {0, 0, -4}, normal, {10, 10})) << "edge on";
    EXPECT_FALSE(editor::plane_drag(camera, {0, 0, 0}, editor::facing_normal(camera), {10, 10})) << "in the eye";
}

TEST(Pointer, SnapsToMultiples) {
    EXPECT_DOUBLE_EQ(editor::snapped(0.26, 0.1, true), 0.3);
    EXPECT_DOUBLE_EQ(editor::snapped(-0.26, 0.1, true), -0.3);
    EXPECT_DOUBLE_EQ(editor::snapped(0.26, 0.1, false), 0.26);
}

}  // namespace
}  // namespace neuvv
