// Eyes as cameras, against the definition of OpenXR's specification: an image spans the tangents of its field of view's
// angles, from its left and upper edge on.
#include "xr/draw/eye_camera.h"

#include <gtest/gtest.h>

#include "reference/camera.h"
#include "xr/random_poses.h"

namespace neuvv::test {
namespace {

constexpr VkExtent2D kSize{300, 200};

XrFovf random_fov(RandomPoses& random) {
    const auto angle = [&](double low, double high) { return static_cast<float>(random.number(low, high)); };
    return {angle(-1.2, -0.3), angle(-0.2, 1.2), angle(-0.1, 1.1), angle(-1.3, -0.4)};
}

// The pixel in which a point is seen, by the specification.
glm::dvec2 pixel_of(const xr::EyeView& eye, glm::dvec3 position_in_eye) {
    const double x = position_in_eye.x / -position_in_eye.z, y = position_in_eye.y / -position_in_eye.z;
    const double left = std::tan(double{eye.fov.angleLeft}), right = std::tan(double{eye.fov.angleRight});
    const double up = std::tan(double{eye.fov.angleUp}), down = std::tan(double{eye.fov.angleDown});
    return {kSize.width * (x - left) / (right - left), kSize.height * (up - y) / (up - down)};
}

TEST(EyeCamera, RaysOfItsPixelsMeetWhatTheEyeSeesThere) {
    RandomPoses random(1);
    for (int i = 0; i < 200; ++i) {
        const xr::EyeView eye{random.pose(), random_fov(random)};
        const xr::Pose rig = random.pose();
        const stage::Camera camera = xr::eye_camera(eye, rig, kSize);
        ASSERT_EQ(camera.width, kSize.width);
        ASSERT_EQ(camera.height, kSize.height);
        const glm::dvec3 position(random.number(-2, 2), random.number(-2, 2), random.number(-4, -0.5));
        const glm::dvec2 pixel = pixel_of(eye, position);
        const reference::Ray ray = reference::camera_ray(camera, pixel.x - 0.5, pixel.y - 0.5);
        const glm::dvec3 in_world = rig * (eye.pose * position), offset = in_world - ray.origin;
        EXPECT_LT(glm::length(glm::cross(ray.direction, offset)), 1e-9 * glm::length(offset)) << i;
        EXPECT_GT(glm::dot(ray.direction, offset), 0) << i;
    }
}

TEST(EyeCamera, AnglesThatSpanNothingAreNoImage) {
    EXPECT_TRUE(xr::spans_image({-0.8f, 0.7f, 0.8f, -0.8f}));
    EXPECT_TRUE(xr::spans_image({0.1f, 0.7f, 0.8f, 0.2f})) << "the axis may lie beside the image";
    const auto nan = static_cast<float>(kNan), infinite = static_cast<float>(kInfinite);
    for (const XrFovf& fov :
         {XrFovf{}, XrFovf{0.7f, -0.8f, 0.8f, -0.8f}, XrFovf{-0.8f, 0.7f, -0.8f, 0.8f},
          XrFovf{-1.6f, 0.7f, 0.8f, -0.8f}, XrFovf{-0.8f, 0.7f, 2, -0.8f}, XrFovf{nan, 0.7f, 0.8f, -0.8f},
          XrFovf{-0.8f, 0.7f, 0.8f, nan}, XrFovf{-infinite, infinite, 0.8f, -0.8f}, XrFovf{0.5f, 0.5f, 0.8f, -0.8f}})
        EXPECT_FALSE(xr::spans_image(fov)) << fov.angleLeft << " " << fov.angleRight << " " << fov.angleUp;
}

TEST(EyeCamera, AMeshOnTheEyesPlaneLiesWhereItsCornersAreSeen) {
    RandomPoses random(2);
    const xr::EyeView eye{{}, random_fov(random)};
    std::vector<XrVector2f> vertices;
    for (int i = 0; i < 6; ++i)
        vertices.push_back({static_cast<float>(random.number(-2, 2)), static_cast<float>(random.number(-2, 2))});
    const std::vector<uint32_t> indices{0, 1, 2, 5, 4, 3, 1, 2};  // two triangles, and two indices that are left over
    const std::vector<glm::vec2> corners = xr::corners_in_image(vertices, indices, eye.fov);
    ASSERT_EQ(corners.size(), 6u);
    for (size_t i = 0; i < corners.size(); ++i) {
        const XrVector2f& vertex = vertices[indices[i]];
        const glm::dvec2 pixel = pixel_of(eye, {vertex.x, vertex.y, -1});
        EXPECT_NEAR(corners[i].x, pixel.x / kSize.width, 1e-5) << i;
        EXPECT_NEAR(corners[i].y, pixel.y / kSize.height, 1e-5) << i;
    }
}

TEST(EyeCamera, AMeshWhoseIndicesLieBesideItHidesNothing) {
    const std::vector<XrVector2f> vertices(3);
    EXPECT_TRUE(xr::corners_in_image(vertices, std::vector<uint32_t>{0, 1, 3}, {-1, 1, 1, -1}).empty());
    EXPECT_TRUE(xr::corners_in_image(vertices, std::vector<uint32_t>{0, 1, UINT32_MAX}, {-1, 1, 1, -1}).empty());
    EXPECT_TRUE(xr::corners_in_image({}, std::vector<uint32_t>{0, 0, 0}, {-1, 1, 1, -1}).empty());
    EXPECT_TRUE(xr::corners_in_image(vertices, {}, {-1, 1, 1, -1}).empty());
}

TEST(EyeCamera, TheInsetLiesAroundTheAxisAndInsideTheImage) {
    stage::Camera eye{.fx = 100, .fy = 100, .cx = 120, .cy = 90, .width = 300, .height = 200};
    const render::Fovea around = xr::fovea_of(eye, 0.5, 0.4);
    EXPECT_LT(glm::distance(around.first, glm::dvec2(0.15, 0.2)), 1e-12);
    EXPECT_LT(glm::distance(around.last, glm::dvec2(0.65, 0.7)), 1e-12);
    EXPECT_EQ(around.beside, 0.4);
    eye.cx = 290;  // the axis is too near to the right edge, and above the image
    eye.cy = -50;
    const render::Fovea pushed = xr::fovea_of(eye, 0.5, 0.4);
    EXPECT_LT(glm::distance(pushed.first, glm::dvec2(0.5, 0)), 1e-12);
    EXPECT_LT(glm::distance(pushed.last, glm::dvec2(1, 0.5)), 1e-12);
}

TEST(EyeCamera, TheInsetFollowsTheGaze) {
    stage::Camera eye{.fx = 100, .fy = 100, .cx = 150, .cy = 100, .width = 300, .height = 200};
    eye.world_from_camera[3] = glm::dvec4(1, 2, 3, 1);
    // Half a metre to the right and a quarter up, at a distance of one metre: 50 and 25 pixels from the axis.
    const render::Fovea there = xr::fovea_of(eye, 0.5, 0.4, glm::dvec3(1.5, 2.25, 2));
    EXPECT_LT(glm::distance(there.first, glm::dvec2(200.0 / 300 - 0.25, 75.0 / 200 - 0.25)), 1e-12);
    EXPECT_LT(glm::distance(there.last, glm::dvec2(200.0 / 300 + 0.25, 75.0 / 200 + 0.25)), 1e-12);
    const render::Fovea pushed = xr::fovea_of(eye, 0.5, 0.4, glm::dvec3(-9, 2, 2.9));
    EXPECT_LT(glm::distance(pushed.first, glm::dvec2(0, 0.25)), 1e-12) << "it stays in the image";
    EXPECT_EQ(xr::fovea_of(eye, 0.5, 0.4, glm::dvec3(1, 2, 4)), xr::fovea_of(eye, 0.5, 0.4)) << "behind the eye";
}

}  // namespace
}  // namespace neuvv::test
