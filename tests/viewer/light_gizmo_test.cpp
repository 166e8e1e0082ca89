#include "tools/viewer/tools/light_gizmo.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/viewer/some_eye.h"

namespace neuvv {
namespace {

using std::numbers::pi;

constexpr double kDegree = pi / 180;

// Seen from the side: the eye stands on +Z, the light shines to the right.
viewer::LightGizmo from_the_side() {
    viewer::LightGizmo gizmo{viewer::camera_of(viewer::Eye{.distance = 8}, 640, 480)};
    gizmo.light = {stage::GltfLightKind::kSpot, {-1, 0, 0}, {1, 0, 0}, 0.4, 0.3, 1.5};
    return gizmo;
}
viewer::LightGizmo askew() {
    viewer::LightGizmo gizmo{test::some_camera()};
    gizmo.light = {stage::GltfLightKind::kSpot, {-0.5, 2, -1}, {0.3, 0.6, 0.2}, 0.3, 0.1, 2.2};
    return gizmo;
}
// Seen from where it shines to.
viewer::LightGizmo from_the_front() {
    viewer::LightGizmo gizmo = from_the_side();
    gizmo.light.position = {0.1, 0.2, -2};
    gizmo.light.aim = {0.1, 0.2, 0};
    return gizmo;
}

glm::dvec2 pixel_of(const viewer::LightGizmo& gizmo, glm::dvec3 world) {
    return editor::pixel_of(gizmo.camera, world).value();
}
std::set<int> handles_of(const viewer::LightGizmo& gizmo) {
    std::set<int> handles;
    for (const viewer::HandleShape& shape : viewer::light_shapes(gizmo)) handles.insert(shape.handle);
    handles.erase(0);
    return handles;
}
glm::dvec2 centre_of(const viewer::LightGizmo& gizmo, viewer::LightHandle handle) {
    for (const viewer::HandleShape& shape : viewer::light_shapes(gizmo))
        if (shape.handle == static_cast<int>(handle) && shape.filled)
            return glm::dvec2(shape.points[0] + shape.points[2]) / 2.0;
    ADD_FAILURE() << "no such handle";
    return {};
}

TEST(LightGizmo, HasTheHandlesOfItsKind) {
    viewer::LightGizmo gizmo = askew();
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{1, 2, 3}));
    gizmo.light.range_m = 0;
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{1, 2}));
    gizmo.light.kind = stage::GltfLightKind::kPoint;
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{}));
    gizmo.light.range_m = 2;
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{3}));
    gizmo.light.kind = stage::GltfLightKind::kDirectional;
    EXPECT_EQ(handles_of(gizmo), (std::set<int>{1}));
}

TEST(LightGizmo, IsMadeOfALightOfTheStage) {
    stage::EvaluatedLight light;
    light.kind = stage::GltfLightKind::kSpot;
    light.position = {1, 2, 3};
    light.direction = {0, -1, 0};
    light.range_m = 4;
    light.cos_inner = std::cos(0.2);
    light.cos_outer = std::cos(0.6);
    const viewer::AimedLight aimed = viewer::aimed_light(light, 2);
    EXPECT_EQ(aimed.aim, glm::dvec3(1, 0, 3));
    EXPECT_NEAR(aimed.outer_cone_rad, 0.6, 1e-12);
    EXPECT_NEAR(aimed.inner_cone_rad, 0.2, 1e-12);
    EXPECT_EQ(aimed.range_m, 4);
    EXPECT_LT(glm::length(aimed.direction() - light.direction), 1e-12);
}

TEST(LightGizmo, TheAimFollowsThePointer) {
    const viewer::LightGizmo gizmo = askew();
    const glm::dvec2 from = pixel_of(gizmo, gizmo.light.aim), to(400, 300);
    EXPECT_EQ(viewer::light_handle_at(gizmo, from), viewer::LightHandle::kAim);
    const viewer::AimedLight after = viewer::dragged(gizmo, viewer::LightHandle::kAim, from, to, false);
    EXPECT_LT(glm::distance(pixel_of(gizmo, after.aim), to), 1e-9);
    EXPECT_NEAR(editor::depth_of(gizmo.camera, after.aim), editor::depth_of(gizmo.camera, gizmo.light.aim), 1e-9);
    EXPECT_EQ(after.position, gizmo.light.position);
    const glm::dvec3 right = gizmo.camera.world_from_camera[0];
    const double move =
        glm::dot(viewer::dragged(gizmo, viewer::LightHandle::kAim, from, to, true).aim - gizmo.light.aim, right);
    EXPECT_NEAR(move, std::round(glm::dot(after.aim - gizmo.light.aim, right) * 10) / 10, 1e-9);
}

TEST(LightGizmo, TheRimOpensTheConeToThePointer) {
    const viewer::LightGizmo gizmo = from_the_side();
    const viewer::AimedLight& light = gizmo.light;
    const auto at = [&](double angle) {
        return pixel_of(gizmo, light.position + 2.0 * glm::dvec3(std::cos(angle), std::sin(angle), 0));
    };
    for (const double side : {1.0, -1.0}) {
        EXPECT_EQ(viewer::light_handle_at(gizmo, at(0.4 * side)), viewer::LightHandle::kRim);
        for (const double angle : {0.1, 0.4, 1.0, 1.5})
            EXPECT_NEAR(viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4 * side), at(angle * side), false)
                            .outer_cone_rad,
                        angle, 1e-9);
        EXPECT_NEAR(
            viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4 * side), at(0.5 * side), true).outer_cone_rad,
            30 * kDegree, 1e-9);
        EXPECT_EQ(viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4 * side), at(2 * side), false).outer_cone_rad,
                  pi / 2);
        EXPECT_NEAR(viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4 * side), at(0), false).outer_cone_rad,
                    viewer::kMinCone_deg * kDegree, 1e-9);
    }
    const viewer::AimedLight narrow = viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4), at(0.2), false);
    EXPECT_LT(narrow.inner_cone_rad, narrow.outer_cone_rad);
    EXPECT_GT(narrow.inner_cone_rad, 0.9 * narrow.outer_cone_rad);
    EXPECT_EQ(viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4), at(0.6), false).inner_cone_rad,
              light.inner_cone_rad);
}

TEST(LightGizmo, TheRimOpensTheConeFromTheFrontToo) {
    const viewer::LightGizmo gizmo = from_the_front();
    const viewer::AimedLight& light = gizmo.light;
    const double ahead = 2 * std::cos(light.outer_cone_rad);
    // Any point of the rim can be grabbed.
    for (const double turn : {0.0, 1.0, 4.0}) {
        const auto at = [&](double angle) {
            const double out = ahead * std::tan(angle);
            return pixel_of(gizmo, light.position + glm::dvec3(out * std::cos(turn), out * std::sin(turn), ahead));
        };
        EXPECT_EQ(viewer::light_handle_at(gizmo, at(0.4)), viewer::LightHandle::kRim);
        for (const double angle : {0.1, 0.4, 0.9})
            EXPECT_NEAR(viewer::dragged(gizmo, viewer::LightHandle::kRim, at(0.4), at(angle), false).outer_cone_rad,
                        angle, 1e-9);
    }
}

TEST(LightGizmo, TheRangeFollowsThePointer) {
    for (const viewer::LightGizmo& gizmo : {from_the_side(), askew()}) {
        const viewer::AimedLight& light = gizmo.light;
        const auto at = [&](double range) { return pixel_of(gizmo, light.position + light.direction() * range); };
        EXPECT_LT(glm::distance(centre_of(gizmo, viewer::LightHandle::kRange), at(light.range_m)), 1e-9);
        for (const double range : {0.3, 1.0, 2.8})
            EXPECT_NEAR(
                viewer::dragged(gizmo, viewer::LightHandle::kRange, at(light.range_m), at(range), false).range_m, range,
                1e-9);
        EXPECT_NEAR(viewer::dragged(gizmo, viewer::LightHandle::kRange, at(light.range_m), at(1.26), true).range_m, 1.3,
                    1e-9);
        EXPECT_EQ(viewer::dragged(gizmo, viewer::LightHandle::kRange, at(light.range_m), at(-1), false).range_m,
                  viewer::kMinRange_m);
    }
}

TEST(LightGizmo, APointsRangeIsACircle) {
    viewer::LightGizmo gizmo = askew();
    gizmo.light.kind = stage::GltfLightKind::kPoint;
    gizmo.light.range_m = 0.8;
    const glm::dvec3 position = gizmo.light.position;
    const glm::dvec3 across =
        editor::perpendicular_to(glm::normalize(glm::dvec3(gizmo.camera.world_from_camera[3]) - position));
    const auto at = [&](double range) { return pixel_of(gizmo, position + across * range); };
    EXPECT_EQ(viewer::light_handle_at(gizmo, at(0.8)), viewer::LightHandle::kRange);
    EXPECT_NEAR(viewer::dragged(gizmo, viewer::LightHandle::kRange, at(0.8), at(1.3), false).range_m, 1.3, 1e-9);
}

TEST(LightGizmo, DragsHaveNoJumps) {
    for (const viewer::LightGizmo& gizmo : {from_the_side(), askew(), from_the_front()})
        for (const viewer::LightHandle handle :
             {viewer::LightHandle::kAim, viewer::LightHandle::kRim, viewer::LightHandle::kRange})
            for (const glm::dvec2 direction : {glm::dvec2(1, 0.3), glm::dvec2(-0.2, 1)}) {
                viewer::AimedLight before = gizmo.light;
                for (int i = 0; i <= 2000; ++i) {
                    const glm::dvec2 from(330, 230), to = from + direction * (i * 0.5);
                    const viewer::AimedLight after = viewer::dragged(gizmo, handle, from, to, false);
                    ASSERT_LT(glm::distance(after.aim, before.aim), 0.05);
                    ASSERT_LT(std::abs(after.outer_cone_rad - before.outer_cone_rad), 0.06);
                    ASSERT_LT(std::abs(after.range_m - before.range_m),
                              0.2 * editor::kMaxDepthFactor * gizmo.light.range_m);
                    before = after;
                }
            }
}

TEST(LightGizmo, StrangeInputIsHarmless) {
    const viewer::LightGizmo gizmo = askew();
    for (const viewer::LightHandle handle : {viewer::LightHandle::kNone, viewer::LightHandle::kAim,
                                             viewer::LightHandle::kRim, viewer::LightHandle::kRange})
        for (const double strange : {-double{FLT_MAX}, std::nan("")}) {
            const viewer::AimedLight after = viewer::dragged(gizmo, handle, {300, 200}, {strange, 0}, false);
            EXPECT_EQ(after.aim, gizmo.light.aim);
            EXPECT_EQ(after.outer_cone_rad, gizmo.light.outer_cone_rad);
            EXPECT_EQ(after.range_m, gizmo.light.range_m);
        }
    viewer::LightGizmo nowhere = gizmo;
    nowhere.light.aim = nowhere.light.position;
    EXPECT_TRUE(viewer::light_shapes(nowhere).empty());
    EXPECT_EQ(viewer::dragged(nowhere, viewer::LightHandle::kAim, {1, 1}, {30, 30}, false).aim, nowhere.light.aim);
    viewer::LightGizmo behind = gizmo;
    const glm::dvec3 back = gizmo.camera.world_from_camera[2];
    behind.light.position = glm::dvec3(gizmo.camera.world_from_camera[3]) + back * 3.0;
    behind.light.aim = behind.light.position + back;
    EXPECT_TRUE(viewer::light_shapes(behind).empty());
}

}  // namespace
}  // namespace neuvv
