#include "tools/viewer/tools/navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "editor/pointer.h"
#include "support/near.h"
#include "tests/viewer/some_eye.h"

namespace neuvv {
namespace {

using std::numbers::pi;
using test::expect_near;
using test::some_eye;
constexpr uint32_t kWidth = 640, kHeight = 480;

glm::dvec3 position_of(const viewer::Eye& eye) {
    return viewer::world_from_eye(eye)[3];
}
glm::dvec3 forward(const viewer::Eye& eye) {
    return -glm::dvec3(viewer::world_from_eye(eye)[2]);
}
glm::dvec2 pixel_of(const viewer::Eye& eye, glm::dvec3 world) {
    return editor::pixel_of(viewer::camera_of(eye, kWidth, kHeight), world).value();
}

TEST(Navigation, TheEyeLooksAtItsPivotLevel) {
    const viewer::Eye eye = some_eye();
    const glm::dmat4 world = viewer::world_from_eye(eye);
    const glm::dmat3 axes(world);
    expect_near(position_of(eye) + forward(eye) * eye.distance, eye.pivot);
    EXPECT_NEAR(axes[0].y, 0, 1e-12) << "the horizon is level";
    EXPECT_GT(axes[1].y, 0);
    EXPECT_NEAR(glm::determinant(axes), 1, 1e-12);
    EXPECT_LT(forward(eye).y, 0) << "a negative pitch looks down";
    viewer::Eye left;
    left.yaw = pi / 2;
    expect_near(forward(left), {-1, 0, 0});
}

TEST(Navigation, ItsCameraHasItsAngleOfView) {
    const viewer::Eye eye = some_eye();
    const stage::Camera camera = viewer::camera_of(eye, kWidth, kHeight);
    EXPECT_LT(glm::length(pixel_of(eye, eye.pivot) - glm::dvec2(kWidth / 2.0, kHeight / 2.0)), 1e-9);
    const glm::dvec3 top = editor::ray_through(camera, {kWidth / 2.0, 0}).direction;
    EXPECT_NEAR(2 * std::acos(glm::dot(top, forward(eye))), eye.angle_y, 1e-12);
    EXPECT_EQ(camera.fx, camera.fy);
}

TEST(Navigation, OrbitingTurnsTheSceneWithThePointer) {
    const viewer::Eye eye = some_eye();
    const glm::dvec3 nearer = eye.pivot - forward(eye) * 0.5;  // than the pivot
    for (const glm::dvec2 moved : {glm::dvec2(10, 0), glm::dvec2(0, 10), glm::dvec2(-10, -10)}) {
        const viewer::Eye after = viewer::orbited(eye, moved, kHeight);
        EXPECT_EQ(after.pivot, eye.pivot);
        EXPECT_NEAR(glm::length(position_of(after) - eye.pivot), eye.distance, 1e-12);
        const glm::dvec2 went = pixel_of(after, nearer) - pixel_of(eye, nearer);
        EXPECT_GT(glm::dot(went, moved), 0);
    }
    EXPECT_NEAR(viewer::orbited(eye, {kHeight / 4.0, 0}, kHeight).yaw, eye.yaw - pi / 4, 1e-12);
    expect_near(viewer::world_from_eye(viewer::orbited(eye, {2.0 * kHeight, 0}, kHeight)), viewer::world_from_eye(eye));
}

TEST(Navigation, OrbitingStopsAtThePoles) {
    for (const double sign : {1.0, -1.0}) {
        const viewer::Eye pole = viewer::orbited(some_eye(), {0, sign * 3 * kHeight}, kHeight);
        expect_near(forward(pole), {0, -sign, 0});
        const viewer::Eye back = viewer::orbited(pole, {0, -sign * kHeight / 4.0}, kHeight);
        EXPECT_NEAR(std::abs(forward(back).y), std::sqrt(0.5), 1e-9);
        EXPECT_NEAR(glm::dmat3(viewer::world_from_eye(back))[0].y, 0, 1e-12);
    }
}

TEST(Navigation, LookingAroundStandsStill) {
    const viewer::Eye eye = some_eye(), after = viewer::turned(eye, {30, 20}, kHeight);
    expect_near(position_of(after), position_of(eye));
    const glm::dvec3 of = glm::dvec3(glm::inverse(viewer::world_from_eye(eye)) * glm::dvec4(forward(after), 0));
    EXPECT_GT(of.x, 0) << "to the right";
    EXPECT_LT(of.y, 0) << "downwards";
}

TEST(Navigation, PanningKeepsTheGrabbedPointUnderThePointer) {
    const viewer::Eye eye = some_eye();
    const glm::dvec2 from(100, 300), to(420, 60);
    const glm::dvec3 grabbed =
        editor::plane_drag(viewer::camera_of(eye, kWidth, kHeight), eye.pivot, forward(eye), from).value();
    const viewer::Eye after = viewer::panned(eye, to - from, kHeight);
    EXPECT_LT(glm::length(pixel_of(after, grabbed) - to), 1e-9);
    expect_near(forward(after), forward(eye));
}

TEST(Navigation, TheWheelKeepsThePointUnderThePointer) {
    const viewer::Eye eye = some_eye();
    const glm::dvec3 point(1, 0.5, 0.4);
    for (const double notches : {1.0, -1.0, 7.0, -20.0}) {
        const viewer::Eye after = viewer::dollied(eye, notches, point);
        EXPECT_LT(glm::length(pixel_of(after, point) - pixel_of(eye, point)), 1e-8);
        EXPECT_NEAR(after.distance, eye.distance * std::pow(0.9, notches), 1e-12);
        expect_near(viewer::world_from_eye(viewer::dollied(after, -notches, point)), viewer::world_from_eye(eye), 1e-8);
    }
}

TEST(Navigation, TheWheelNeverPassesThePivot) {
    viewer::Eye eye = some_eye();
    const glm::dvec3 pivot = eye.pivot, direction = forward(eye);
    for (int i = 0; i < 1000; ++i) {
        eye = viewer::dollied(eye, 3);
        ASSERT_GT(glm::dot(pivot - position_of(eye), direction), 0);
    }
    EXPECT_EQ(eye.distance, viewer::kMinEyeDistance_m);
    for (int i = 0; i < 1000; ++i) eye = viewer::dollied(eye, -3, glm::dvec3(1, 2, 3));
    EXPECT_EQ(eye.distance, viewer::kMaxEyeDistance_m);
    EXPECT_TRUE(std::isfinite(glm::length(position_of(eye))));
}

TEST(Navigation, WholeNumbersAreAWheel) {
    EXPECT_TRUE(viewer::is_wheel({{0, 1}}));
    EXPECT_TRUE(viewer::is_wheel({{0, -3}}));
    EXPECT_FALSE(viewer::is_wheel({{0, 0.1}}));
    EXPECT_FALSE(viewer::is_wheel({{1, 0}}));
    const viewer::Eye eye = some_eye();
    expect_near(viewer::world_from_eye(viewer::scrolled(eye, {{0, 1}, true}, kHeight)),
                viewer::world_from_eye(viewer::dollied(eye, 1)));
    const glm::dvec2 moved = glm::dvec2(0.5, -0.25) * (0.05 * kHeight);
    const glm::dvec2 pad(0.5, -0.25);
    expect_near(viewer::world_from_eye(viewer::scrolled(eye, {pad}, kHeight)),
                viewer::world_from_eye(viewer::orbited(eye, moved, kHeight)));
    expect_near(viewer::world_from_eye(viewer::scrolled(eye, {pad, true}, kHeight)),
                viewer::world_from_eye(viewer::panned(eye, moved, kHeight)));
    expect_near(viewer::world_from_eye(viewer::scrolled(eye, {pad, false, true}, kHeight)),
                viewer::world_from_eye(viewer::dollied(eye, -0.25)));
}

TEST(Navigation, FlightGoesWhereTheKeysSay) {
    const viewer::Eye eye = some_eye();
    const glm::dvec3 right = glm::dvec3(viewer::world_from_eye(eye)[0]);
    const auto direction = [&](const viewer::FlightKeys& keys) {
        return position_of(viewer::flown(eye, keys, 0.1, 10)) - position_of(eye);
    };
    expect_near(direction({1, 0, 0}), forward(eye) * 0.5);
    expect_near(direction({0, -1, 0}), -right * 0.5);
    expect_near(direction({0, 0, 1}), {0, 0.5, 0});
    expect_near(direction({1, 0, 0, true}), forward(eye) * 2.0);
    expect_near(direction({1, 0, 0, false, true}), forward(eye) * 0.125);
    EXPECT_NEAR(glm::length(direction({1, 1, 0})), 0.5, 1e-12) << "diagonally no faster";
    expect_near(direction({1, -1, 0}), (forward(eye) - right) * (0.5 / std::sqrt(2.0)));
    expect_near(direction({}), glm::dvec3(0));
    expect_near(position_of(viewer::flown(eye, {1}, 60, 10)) - position_of(eye), direction({1}));
    expect_near(forward(viewer::flown(eye, {1, 1, 1}, 0.1, 10)), forward(eye));
}

TEST(Navigation, AFramedBoxFillsTheImage) {
    const glm::dvec3 low(-1, 0.2, -0.5), high(0.7, 2, 3);
    for (const double yaw : {0.0, 0.7, 2.5, -1.0})
        for (const double pitch : {-pi / 2, -0.4, 0.0, 1.2})
            for (const uint32_t width : {200u, 480u, 1600u}) {
                viewer::Eye eye = some_eye();
                eye.yaw = yaw, eye.pitch = pitch;
                const viewer::Eye after = viewer::framed(eye, low, high, double{static_cast<double>(width)} / kHeight);
                const stage::Camera camera = viewer::camera_of(after, width, kHeight);
                double outermost = 0;
                for (int i = 0; i < 8; ++i) {
                    const auto pixel = editor::pixel_of(
                        camera, {i & 1 ? low.x : high.x, i & 2 ? low.y : high.y, i & 4 ? low.z : high.z});
                    ASSERT_TRUE(pixel);
                    outermost =
                        std::max({outermost, std::abs(pixel->x / camera.cx - 1), std::abs(pixel->y / camera.cy - 1)});
                }
                EXPECT_NEAR(outermost, 0.9, 1e-9);
                expect_near(forward(after), forward(eye));
                expect_near(after.pivot, (low + high) / 2.0);
            }
}

TEST(Navigation, StrangeBoxesAreHarmless) {
    const viewer::Eye eye = some_eye();
    const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const double wrong : {inf, -inf, nan, 1e300})
        for (int i = 0; i < 3; ++i) {
            glm::dvec3 high(1);
            high[i] = wrong;
            expect_near(viewer::world_from_eye(viewer::framed(eye, glm::dvec3(0), high, 1.5)),
                        viewer::world_from_eye(eye));
        }
    const viewer::Eye point = viewer::framed(eye, glm::dvec3(3), glm::dvec3(3), 1.5);
    EXPECT_EQ(point.distance, 1);
    expect_near(point.pivot, glm::dvec3(3));
}

TEST(Navigation, SidesAreSeenLevel) {
    viewer::Eye eye = some_eye();
    eye.roll = 0.3;
    const std::pair<viewer::EyeSide, glm::dvec3> sides[] = {
        {viewer::EyeSide::kFront, {0, 0, 1}}, {viewer::EyeSide::kBack, {0, 0, -1}},
        {viewer::EyeSide::kRight, {1, 0, 0}}, {viewer::EyeSide::kLeft, {-1, 0, 0}},
        {viewer::EyeSide::kTop, {0, 1, 0}},   {viewer::EyeSide::kBottom, {0, -1, 0}}};
    for (const auto& [side, from] : sides) {
        const viewer::Eye after = viewer::seen_from(eye, side);
        expect_near(position_of(after) - eye.pivot, from * eye.distance);
        EXPECT_NEAR(viewer::world_from_eye(after)[0].y, 0, 1e-12);
    }
    expect_near(glm::dvec3(viewer::world_from_eye(viewer::seen_from(eye, viewer::EyeSide::kTop))[1]), {0, 0, -1});
}

TEST(Navigation, LooksThroughAnyCamera) {
    for (const double yaw : {-3.0, 0.0, 1.0})
        for (const double pitch : {-pi / 2, -1.5, 0.0, 0.8, pi / 2})
            for (const double roll : {-2.5, 0.0, 0.6}) {
                glm::dmat4 world = glm::translate(glm::dmat4(1), glm::dvec3(1, 2, -3));
                world = glm::rotate(world, yaw, glm::dvec3(0, 1, 0));
                world = glm::rotate(world, pitch, glm::dvec3(1, 0, 0));
                world = glm::rotate(world, roll, glm::dvec3(0, 0, 1));
                const viewer::Eye eye = viewer::looking_through(world, 0.5, 2.5);
                expect_near(viewer::world_from_eye(eye), world, 1e-9);
                EXPECT_EQ(eye.angle_y, 0.5);
                EXPECT_EQ(eye.distance, 2.5);
            }
}

TEST(Navigation, ThePivotLiesAtTheBoxsDepth) {
    const glm::dmat4 camera = glm::translate(glm::dmat4(1), glm::dvec3(0, 1, 5));
    EXPECT_NEAR(viewer::distance_to(camera, glm::dvec3(-1), glm::dvec3(1)), 5, 1e-12);
    EXPECT_NEAR(viewer::distance_to(camera, {-1, -1, 9}, {1, 1, 11}), std::sqrt(3.0), 1e-12) << "behind";
    EXPECT_EQ(viewer::distance_to(camera, glm::dvec3(0, 0, 9), glm::dvec3(0, 0, 9)), viewer::kMinEyeDistance_m);
}

TEST(Navigation, AMoveEndsExactly) {
    const viewer::Eye from = some_eye();
    viewer::Eye to = viewer::seen_from(from, viewer::EyeSide::kTop);
    to.pivot = {3, 4, 5}, to.distance = 11, to.angle_y = 1.1;
    for (const double at : {viewer::kEyeMove_s, viewer::kEyeMove_s + 1e-9, 7.0}) {
        const viewer::Eye end = viewer::between(from, to, at);
        EXPECT_EQ(end.pivot, to.pivot);
        EXPECT_EQ(viewer::world_from_eye(end), viewer::world_from_eye(to));
        EXPECT_EQ(end.angle_y, to.angle_y);
    }
    expect_near(viewer::world_from_eye(viewer::between(from, to, 0)), viewer::world_from_eye(from));
    expect_near(viewer::world_from_eye(viewer::between(from, to, -1)), viewer::world_from_eye(from));
    EXPECT_NEAR(viewer::between(from, to, viewer::kEyeMove_s / 2).distance, std::sqrt(from.distance * to.distance),
                1e-12);
}

TEST(Navigation, AMoveIsSmoothAndGoesTheShorterWay) {
    viewer::Eye from = some_eye(), to = some_eye();
    from.yaw = 3, to.yaw = -3;
    double before = from.yaw;
    constexpr int kSteps = 2000;
    for (int i = 1; i <= kSteps; ++i) {
        const double yaw = viewer::between(from, to, viewer::kEyeMove_s * i / kSteps * (1 - 1e-12)).yaw;
        EXPECT_GE(yaw, before) << "through π";
        EXPECT_LT(yaw - before, 1.6 * (2 * pi - 6) / kSteps);
        before = yaw;
    }
    EXPECT_NEAR(before, 2 * pi - 3, 1e-6);
}

}  // namespace
}  // namespace neuvv
