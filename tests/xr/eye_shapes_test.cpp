#include "xr/draw/eye_shapes.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace neuvv {
namespace {

constexpr glm::vec4 kRed{0.8f, 0.1f, 0.05f, 1}, kClear{0.5f, 0.75f, 1, 0.5f};

xr::EyeShapes seen_from(glm::dvec3 eye, double min_width_rad = 0) {
    xr::EyeShapes shapes;
    shapes.begin(eye, min_width_rad);
    return shapes;
}

// The largest distance of the corners at one end of a line from that end.
double half_width_at(std::span<const xr::ShapeVertex> corners, glm::vec3 end) {
    double widest = 0;
    for (const xr::ShapeVertex& corner : corners)
        if (glm::distance(corner.position, end) < 0.4f)
            widest = std::max(widest, double{glm::distance(corner.position, end)});
    return widest;
}

TEST(EyeShapes, SolidOnesAndClearOnesAreApart) {
    xr::EyeShapes shapes = seen_from({});
    shapes.ball({0, 0, -1}, 0.1, kRed);
    EXPECT_FALSE(shapes.solid().empty());
    EXPECT_TRUE(shapes.translucent().empty());
    const size_t solid = shapes.solid().size();
    shapes.ball({0, 0, -1}, 0.1, kClear);
    EXPECT_EQ(shapes.solid().size(), solid);
    EXPECT_EQ(shapes.translucent().size(), solid) << "the same triangles";
    shapes.line({0, 0, -1}, {0, 0, -2}, 0.01, kRed, glm::vec4(glm::vec3(kRed), 0));
    EXPECT_EQ(shapes.solid().size(), solid) << "a line that fades is clear";
    shapes.begin({}, 0);
    EXPECT_TRUE(shapes.solid().empty() && shapes.translucent().empty() && shapes.holes().empty());
}

TEST(EyeShapes, WhatIsSeenThroughAllIsApart) {
    xr::EyeShapes shapes = seen_from({});
    shapes.draw_on_top(true);
    shapes.ball({0, 0, -1}, 0.1, kRed);
    shapes.line({0, 0, -1}, {0, 0, -2}, 0.01, kClear, kClear);
    EXPECT_TRUE(shapes.solid().empty() && shapes.translucent().empty());
    const size_t through = shapes.on_top().size();
    EXPECT_GT(through, shapes.solid_on_top().size()) << "the line is translucent";
    EXPECT_FALSE(shapes.solid_on_top().empty());
    shapes.draw_on_top(false);
    shapes.ball({0, 0, -1}, 0.1, kRed);
    EXPECT_EQ(shapes.on_top().size(), through);
    EXPECT_FALSE(shapes.solid().empty());
    shapes.begin({}, 0);
    EXPECT_TRUE(shapes.on_top().empty() && shapes.solid_on_top().empty());
}

TEST(EyeShapes, ColoursArePremultiplied) {
    xr::EyeShapes shapes = seen_from({});
    shapes.line({0, 0, -1}, {0, 0, -2}, 0.01, kClear, kClear);
    for (const xr::ShapeVertex& corner : shapes.translucent()) {
        EXPECT_EQ(corner.colour.a, 0.5f);
        EXPECT_EQ(glm::vec3(corner.colour), 0.5f * glm::vec3(kClear));
    }
}

TEST(EyeShapes, LinesStayAsWideAsAPixelHoweverFar) {
    xr::EyeShapes shapes = seen_from({0, 0, 0}, 0.002);
    shapes.line({0, 0, -1}, {0, 0, -100}, 0.01, kRed, kRed);
    EXPECT_NEAR(half_width_at(shapes.solid(), {0, 0, -1}), 0.005, 1e-6) << "near ones are as wide as they say";
    EXPECT_NEAR(half_width_at(shapes.solid(), {0, 0, -100}), 0.1, 1e-5) << "0.002 rad of 100 m";
    shapes.begin({0, 0, 0}, 0.002);
    shapes.line({1, 0, 0}, {1, 0, 0}, 0.01, kRed, kRed);
    EXPECT_TRUE(shapes.solid().empty()) << "a line of no length";
}

TEST(EyeShapes, BallsHaveTheirRadius) {
    xr::EyeShapes shapes = seen_from({});
    const glm::vec3 centre(1, 2, 3);
    shapes.ball(centre, 0.25, kRed);
    for (const xr::ShapeVertex& corner : shapes.solid())
        EXPECT_NEAR(glm::distance(corner.position, centre), 0.25, 1e-6);
    ASSERT_EQ(shapes.solid().size() % 3, 0u);
}

TEST(EyeShapes, BoxesGoWithTheSpaceTheyAreIn) {
    const glm::dmat4 world = glm::translate(glm::dmat4(1), {3, 0, -1}) *
                             glm::rotate(glm::dmat4(1), 0.5, glm::dvec3(0, 1, 0)) *
                             glm::scale(glm::dmat4(1), glm::dvec3(2));
    const glm::dvec3 low(-0.1, 0, -0.2), high(0.1, 0.8, 0.2);
    xr::EyeShapes shapes = seen_from({});
    shapes.solid_box(world, low, high, kRed);
    EXPECT_EQ(shapes.solid().size(), 36u);
    const glm::dmat4 inside = glm::inverse(world);
    for (const xr::ShapeVertex& corner : shapes.solid()) {
        const glm::dvec3 at = inside * glm::dvec4(corner.position, 1);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LT(std::min(std::abs(at[axis] - low[axis]), std::abs(at[axis] - high[axis])), 1e-6) << axis;
    }
    const size_t before = shapes.solid().size();
    shapes.box_edges(world, low, high, 0.01, kRed);
    EXPECT_EQ(shapes.solid().size() - before, 12u * 18u) << "twelve edges of three ribbons";
}

TEST(EyeShapes, AHoleIsTheRectangleAndHidesAllOfIt) {
    xr::EyeShapes shapes = seen_from({});
    const xr::Pose stands{{0, 1, -2}, glm::angleAxis(0.7, glm::dvec3(0, 1, 0))};
    shapes.hole(stands, {0.8, 0.6});
    ASSERT_EQ(shapes.holes().size(), 6u);
    double area = 0;
    for (size_t i = 0; i < 6; i += 3) {
        const auto at = [&](size_t j) { return shapes.holes()[i + j].position; };
        area += 0.5 * double{glm::length(glm::cross(at(1) - at(0), at(2) - at(0)))};
    }
    EXPECT_NEAR(area, 0.8 * 0.6, 1e-6);
    for (const xr::ShapeVertex& corner : shapes.holes()) {
        const glm::dvec3 at = xr::inverse(stands) * glm::dvec3(corner.position);
        EXPECT_NEAR(std::abs(at.x), 0.4, 1e-6);
        EXPECT_NEAR(std::abs(at.y), 0.3, 1e-6);
        EXPECT_NEAR(at.z, 0, 1e-6);
        EXPECT_EQ(corner.colour, glm::vec4(0)) << "what is beneath is seen";
    }
}

}  // namespace
}  // namespace neuvv
