#include "tools/view_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "support/input_error.h"
#include "support/random_tree.h"
#include "voctree/files/occupied_box.h"

namespace neuvv {
namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

// The pixel that shows a world position.
glm::dvec2 project(const stage::Camera& camera, glm::dvec3 position) {
    const glm::dvec3 p = glm::dvec3(glm::inverse(camera.world_from_camera) * glm::dvec4(position, 1));
    EXPECT_LT(p.z, 0) << "behind the camera";
    return {camera.cx - camera.fx * p.x / p.z, camera.cy + camera.fy * p.y / p.z};
}

stage::CameraPath views_of(size_t count, uint32_t width, uint32_t height) {
    stage::CameraPath path;
    path.interpolation = stage::Interpolation::kCut;
    path.width = width;
    path.height = height;
    for (size_t i = 0; i < count; ++i) {
        stage::CameraPathKey key;
        key.time_s = static_cast<double>(i) / 25;
        key.angle_y = 2 * std::atan(0.4);
        path.keys.push_back(key);
    }
    path.duration_s = path.keys.back().time_s;
    return path;
}

TEST(ViewPath, OccupiedBoxIsThatOfTheLeaves) {
    voctree::VOctree tree = test::random_tree({.leaves = 1});
    voctree::build_topology(tree, {{1, 2, 3, 2}, {3, 0, 6, 3}});
    tree.box_min = {-1, 0, 10};
    tree.box_size = {8, 16, 4};
    const auto [low, high] = voctree::occupied_box(tree);
    EXPECT_EQ(low, glm::dvec3(1, 0, 13));    // tree (1/4, 0, 3/4)
    EXPECT_EQ(high, glm::dvec3(3, 12, 14));  // tree (1/2, 3/4, 1)
}

TEST(ViewPath, OccupiedBoxOfAnEmptyTreeIsItsOwn) {
    voctree::VOctree tree = test::random_tree({.leaves = 1});
    voctree::build_topology(tree, {});
    const auto [low, high] = voctree::occupied_box(tree);
    EXPECT_EQ(low, glm::dvec3(tree.box_min));
    EXPECT_EQ(high, glm::dvec3(tree.box_min) + glm::dvec3(tree.box_size));
}

TEST(ViewPath, OrbitShowsTheWholeBoxAndFillsTheImage) {
    const Box box{{-0.5, 0, -0.4}, {0.7, 1.8, 0.4}};
    for (const media::ImageSize size :
         {media::ImageSize{720, 720}, media::ImageSize{1280, 720}, media::ImageSize{300, 500}}) {
        double outermost = 0;
        for (const tools::ViewStep& step : tools::orbit_path(box, {{0, 23}, 25, 25}, size)) {
            EXPECT_NEAR(glm::determinant(glm::dmat3(step.camera.world_from_camera)), 1, 1e-12);
            for (int corner = 0; corner < 8; ++corner) {
                const glm::dvec3 p(corner & 1 ? box.first.x : box.second.x, corner & 2 ? box.first.y : box.second.y,
                                   corner & 4 ? box.first.z : box.second.z);
                const glm::dvec2 pixel = project(step.camera, p) / glm::dvec2(size.width, size.height);
                const glm::dvec2 off = glm::abs(pixel - 0.5);
                outermost = std::max({outermost, off.x, off.y});
            }
        }
        EXPECT_LT(outermost, 0.5);
        EXPECT_GT(outermost, 0.4);
    }
}

TEST(ViewPath, OrbitTurnsOnceInFourSecondsOrMore) {
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    const std::vector<tools::ViewStep> path = tools::orbit_path(box, {{0, 23}, 24, 24}, {64, 64});
    ASSERT_EQ(path.size(), 96u);  // the clip of one second, four times
    for (size_t i = 0; i < path.size(); ++i) EXPECT_NEAR(path[i].frame, static_cast<double>(i % 24), 1e-9);
    // From +Z over +X, looking inwards and a little down.
    EXPECT_NEAR(path[0].camera.world_from_camera[3].x, 0, 1e-9);
    EXPECT_GT(path[0].camera.world_from_camera[3].z, 2);
    EXPECT_GT(path[24].camera.world_from_camera[3].x, 2);
    EXPECT_NEAR(path[24].camera.world_from_camera[3].z, 0, 1e-9);
    EXPECT_LT(path[48].camera.world_from_camera[3].z, -2);
    EXPECT_GT(path[0].camera.world_from_camera[3].y, 0);
    EXPECT_NEAR(glm::length(project(path[30].camera, {0, 0, 0}) - glm::dvec2(32, 32)), 0, 1e-9);

    EXPECT_EQ(tools::orbit_path(box, {{0, 149}, 25, 25}, {64, 64}).size(), 150u);  // six seconds: the clip once
    EXPECT_EQ(tools::orbit_path(box, {{5, 5}, 25, 30}, {64, 64}).size(), 120u);    // one frame for four seconds
}

TEST(ViewPath, FasterOutputFallsBetweenFrames) {
    const std::vector<tools::ViewStep> path = tools::orbit_path({{0, 0, 0}, {1, 1, 1}}, {{2, 4.5}, 10, 40}, {8, 8});
    for (size_t i = 0; i < 14; ++i)
        EXPECT_NEAR(path[i].frame, std::min(4.5, 2 + 0.25 * static_cast<double>(i)), 1e-9) << i;
    EXPECT_NEAR(path[14].frame, 2, 1e-9);  // the clip repeats
}

TEST(ViewPath, TooManyImagesAreRefused) {
    const Box box{{0, 0, 0}, {1, 1, 1}};
    expect_input_error([&] { tools::orbit_path(box, {{0, 99999}, 1, 1000}, {8, 8}); }, {"--fps", "lower --fps"});
    const double tiny = std::numeric_limits<float>::min();
    expect_input_error([&] { tools::orbit_path(box, {{0, 1}, tiny, tiny * 1e9}, {8, 8}); }, {"--fps"});
    expect_input_error([&] { tools::path_steps(views_of(1, 8, 8), {{0, 1}, tiny, 25}, 2, {8, 8}, {8, 8}); }, {"--fps"});
}

TEST(ViewPath, ViewsAreAnImageEach) {
    const tools::Playback playback{{0, 10}, 25, 25};
    stage::CameraPath views = views_of(2, 100, 80);
    views.keys[0].clip_time = 1;
    views.keys[1].clip_time = 0.25;
    const auto timed = tools::path_steps(views, playback, 11, {}, {7, 7});
    ASSERT_EQ(timed.size(), 2u);
    EXPECT_EQ(timed[0].frame, 10);
    EXPECT_EQ(timed[1].frame, 2.5);
    EXPECT_EQ(timed[0].camera.width, 100u);
    EXPECT_EQ(timed[0].camera.height, 80u);
    EXPECT_NEAR(timed[0].camera.fx, 100, 1e-9);

    for (const size_t count : {3, 50, 1000}) {  // however i / 25 is rounded
        const auto playing = tools::path_steps(views_of(count, 10, 8), playback, 11, {}, {7, 7});
        ASSERT_EQ(playing.size(), count);
        EXPECT_EQ(playing[2].frame, 2);
    }
    const auto fixed = tools::path_steps(views_of(1, 10, 8), playback, 11, {}, {7, 7});
    ASSERT_EQ(fixed.size(), 11u);
    EXPECT_EQ(fixed[10].frame, 10);
}

TEST(ViewPath, ImagesOfAPathAreAtTheirInstants) {
    stage::CameraPath path = views_of(3, 0, 0);
    path.interpolation = stage::Interpolation::kLinear;
    for (size_t i = 0; i < 3; ++i) {
        path.keys[i].time_s = static_cast<double>(i);
        path.keys[i].position = {static_cast<double>(i), 0, 0};
    }
    path.duration_s = 2;
    const auto open = tools::path_steps(path, {{0, 10}, 25, 10}, 11, {}, {8, 8});
    ASSERT_EQ(open.size(), 21u) << "both ends are shown";
    for (size_t i = 0; i < open.size(); ++i)
        EXPECT_NEAR(open[i].camera.world_from_camera[3].x, static_cast<double>(i) / 10, 1e-12);
    EXPECT_EQ(open[1].frame, 2.5) << "the clip keeps its speed";
    path.cyclic = true;
    path.duration_s = 3;
    const auto cycle = tools::path_steps(path, {{0, 10}, 25, 10}, 11, {}, {8, 8});
    ASSERT_EQ(cycle.size(), 30u) << "the first key is not shown twice";
    EXPECT_NEAR(cycle[29].camera.world_from_camera[3].x, 0.2, 1e-12);
}

TEST(ViewPath, AnotherSizeKeepsTheVerticalAngleOfView) {
    stage::CameraPath views = views_of(1, 100, 80);
    views.keys[0].clip_time = 0;
    views.keys[0].shift = {0.125, 0};  // 10 of 80 pixels
    const auto path = tools::path_steps(views, {}, 1, {300, 160}, {7, 7});
    const stage::Camera& camera = path.at(0).camera;
    EXPECT_EQ(camera.width, 300u);
    EXPECT_NEAR(camera.fy, 200, 1e-9);
    EXPECT_NEAR(camera.fx, 200, 1e-9);
    EXPECT_EQ(camera.cx, 170);  // 20 right of the middle
    EXPECT_EQ(camera.cy, 80);
}

TEST(ViewPath, KeysWithoutASizeTakeTheFallback) {
    stage::CameraPath views = views_of(1, 0, 0);
    views.keys[0].angle_x = 2 * std::atan(1 / 3.0);
    const auto path = tools::path_steps(views, {{0, 0}, 25, 25}, 1, {}, {200, 100});
    ASSERT_EQ(path.size(), 1u);
    EXPECT_NEAR(path[0].camera.fx, 300, 1e-9);
    EXPECT_NEAR(path[0].camera.fy, 300, 1e-9);
    EXPECT_EQ(path[0].camera.cx, 100);
    EXPECT_EQ(path[0].camera.cy, 50);
}

// Rates as .nvv files and as users write them: no image may drift off the frames of the clip.
TEST(ViewPath, ImagesAtAMultipleOfTheClipsRateHitItsFrames) {
    const Box box{{0, 0, 0}, {1, 1, 1}};
    const double clip_fps = double{29.97f};
    for (const double rate : {29.97, 59.94, 14.985}) {
        const auto path = tools::orbit_path(box, {{0, 8999}, clip_fps, rate}, {8, 8});
        const size_t every = rate > 30 ? 2 : 1;
        for (size_t i = 0; i < path.size(); i += every) EXPECT_EQ(path[i].frame, std::floor(path[i].frame)) << i;
        EXPECT_GT(path.size(), 4000u);
    }
}

TEST(ViewPath, DepthRangeHoldsTheBox) {
    tools::ViewStep step;
    step.camera.world_from_camera[3] = glm::dvec4(0, 0, 10, 1);
    const auto [near, far] = tools::depth_range({step}, {{-1, -1, -1}, {1, 1, 1}});
    EXPECT_NEAR(near, 10 - std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(far, 10 + std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace neuvv
