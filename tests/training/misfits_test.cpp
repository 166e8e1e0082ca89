// Cameras that contradict all others are found, also where two have each other's images; the others never are.
#include "training/tree/misfits.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "support/armed_figure.h"

namespace neuvv::test {
namespace {

using Swaps = std::vector<std::pair<uint32_t, uint32_t>>;
using Cameras = std::vector<uint32_t>;

training::Misfits expect_found(const training::Dataset& dataset, const Swaps& swapped, const Cameras& others) {
    const training::Misfits found = training::find_misfits(dataset);
    Swaps pairs;
    for (const training::SwappedCameras& pair : found.swapped) pairs.emplace_back(pair.a, pair.b);
    Cameras cameras;
    for (const training::Misfit& misfit : found.others) cameras.push_back(misfit.camera);
    EXPECT_EQ(pairs, swapped);
    EXPECT_EQ(cameras, others);
    return found;
}

void swap_images(training::Dataset& dataset, uint32_t a, uint32_t b) {
    for (training::View& view : dataset.views)
        if (view.camera == a || view.camera == b) view.camera = a + b - view.camera;
}

// Turns a camera to the side without its images.
void turn(training::Dataset& dataset, uint32_t camera, double degrees) {
    glm::dmat4& pose = dataset.cameras[camera].world_from_camera;
    pose = glm::rotate(pose, glm::radians(degrees), glm::dvec3(0, 1, 0));
}

void fill_all(training::Dataset& dataset, uint32_t camera, bool opaque) {
    for (size_t i = 0; i < dataset.views.size(); ++i)
        if (dataset.views[i].camera == camera) fill(dataset, i, opaque);
}

TEST(Misfits, CamerasThatAgreeAreNone) {
    for (const uint32_t cameras : {5u, 8u, 13u}) {
        SCOPED_TRACE(cameras);
        expect_found(armed_figure(cameras), {}, {});
    }
}

TEST(Misfits, CamerasMaySeeAPartOnly) {
    for (const double lowered : {12.0, 28.0}) {
        SCOPED_TRACE(lowered);
        expect_found(armed_figure(13, lowered), {}, {});
    }
    training::Dataset dataset = armed_figure(9);
    for (const double half : {0.5, 0.3}) {
        SCOPED_TRACE(half);
        dataset.box = {glm::dvec3(-half), glm::dvec3(half)};
        expect_found(dataset, {}, {});
    }
    // One camera is so near that the body fills its image, another sees the arm's side alone.
    dataset.box.reset();
    dataset.cameras[2].world_from_camera[3] = glm::dvec4(0.2 * glm::dvec3(dataset.cameras[2].world_from_camera[3]), 1);
    turn(dataset, 5, 20);
    for (const uint32_t camera : {2u, 5u}) repaint(dataset, camera);
    expect_found(dataset, {}, {});
}

TEST(Misfits, WrongMattesOfSomeTimesAreNoMisfits) {
    training::Dataset dataset = armed_figure(9);
    fill(dataset, 2 * kFigureFrames, false);
    fill(dataset, 3 * kFigureFrames + 1, true);
    cut_arm(dataset, 6 * kFigureFrames + 2);
    expect_found(dataset, {}, {});
}

TEST(Misfits, CamerasALittleOutOfPlaceOrTimeAreNone) {
    training::Dataset dataset = armed_figure(13);
    turn(dataset, 4, 2);
    for (training::View& view : dataset.views)  // a frame late
        if (view.camera == 9 && view.time < 1)
            view.image = dataset.views[static_cast<size_t>(&view - dataset.views.data()) + 1].image;
    expect_found(dataset, {}, {});
    for (uint32_t camera = 0; camera < 13; ++camera) turn(dataset, camera, camera % 2 == 0 ? 1 : -1);
    expect_found(dataset, {}, {});
}

TEST(Misfits, SwappedCamerasAreFound) {
    for (const uint32_t cameras : {6u, 9u, 16u}) {
        SCOPED_TRACE(cameras);
        training::Dataset dataset = armed_figure(cameras);
        swap_images(dataset, 1, cameras - 2);
        const training::Misfits found = expect_found(dataset, {{1, cameras - 2}}, {});
        ASSERT_EQ(found.swapped.size(), 1u);
        EXPECT_GT(found.swapped[0].unexplained, 0.005);
        EXPECT_LT(found.swapped[0].unexplained_swapped, 0.001);
    }
}

// The small mattes of 320 and of 319 pixels are of one size; a camera cannot read the other's images.
TEST(Misfits, CamerasOfOtherSizesAreNotSwapped) {
    for (const uint32_t side : {320u, 319u}) {
        SCOPED_TRACE(side);
        training::Dataset dataset = armed_figure(9);
        for (uint32_t c = 0; c < 9; ++c) {
            stage::Camera& camera = dataset.cameras[c];
            camera.width = camera.height = c == 2 ? side : 320;
            for (double* pixels : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *pixels *= camera.width / 64.0;
        }
        for (training::View& view : dataset.views) {
            const uint32_t width = dataset.cameras[view.camera].width;
            view.image = training::TiledImage(media::Image(width, width));
        }
        for (uint32_t c = 0; c < 9; ++c) repaint(dataset, c);
        std::swap(dataset.cameras[2].world_from_camera, dataset.cameras[7].world_from_camera);
        const training::Misfits found = training::find_misfits(dataset);
        EXPECT_EQ(found.swapped.size(), side == 320 ? 1u : 0u);
    }
}

TEST(Misfits, SwappedCamerasAreFoundBesideOtherMistakes) {
    training::Dataset dataset = armed_figure(15);
    cut_arm(dataset, 2 * kFigureFrames);
    fill(dataset, 3 * kFigureFrames + 1, true);
    fill_all(dataset, 7, false);
    turn(dataset, 10, 9);
    swap_images(dataset, 0, 5);
    swap_images(dataset, 4, 12);
    expect_found(dataset, {{0, 5}, {4, 12}}, {7, 10});
}

// Swapped images of one time, too; whether a single matte is wrong, doubtful_mattes.h says.
TEST(Misfits, AStillTellsSwappedCamerasOnly) {
    training::Dataset dataset = armed_figure(9);
    std::erase_if(dataset.views, [](const training::View& view) { return view.time > 0; });
    dataset.times = {0};
    training::Dataset wrong = dataset;
    fill(wrong, 4, false);
    expect_found(wrong, {}, {});
    swap_images(dataset, 3, 7);
    expect_found(dataset, {{3, 7}}, {});
}

TEST(Misfits, AWrongCameraIsFound) {
    for (const uint32_t cameras : {5u, 9u}) {
        SCOPED_TRACE(cameras);
        const training::Dataset truth = armed_figure(cameras);
        training::Dataset turned = truth, empty = truth;
        turn(turned, 3, 12);
        fill_all(empty, 3, false);
        for (const training::Dataset& dataset : {turned, empty}) expect_found(dataset, {}, {3});
    }
    training::Dataset full = armed_figure(12);
    fill_all(full, 3, true);
    const training::Misfits found = expect_found(full, {}, {3});
    ASSERT_EQ(found.others.size(), 1u);
    EXPECT_GT(found.others[0].fit.unexplained, 0.3);
    EXPECT_EQ(found.others[0].fit.denied, 0);
}

// Two empty cameras share the blame: neither denies anything alone.
TEST(Misfits, TwoCamerasWithEmptyMattesAreFound) {
    training::Dataset dataset = armed_figure(9);
    fill_all(dataset, 2, false);
    fill_all(dataset, 6, false);
    const training::Misfits found = expect_found(dataset, {}, {2, 6});
    ASSERT_EQ(found.others.size(), 2u);
    EXPECT_EQ(found.others[0].fit.unexplained, 0);
    EXPECT_GT(found.others[0].fit.denied, 0.7) << "each is judged beside those that agree";
}

TEST(Misfits, FewCamerasAndHopelessRigsAreLeftAlone) {
    training::Dataset four = armed_figure(4);
    fill_all(four, 1, false);
    expect_found(four, {}, {});
    training::Dataset hopeless = armed_figure(8);
    for (const uint32_t camera : {0u, 2u, 4u, 6u}) turn(hopeless, camera, camera < 3 ? 9 : -9);
    expect_found(hopeless, {}, {});
    training::Dataset nobody = armed_figure(8);
    for (uint32_t camera = 0; camera < 8; ++camera) fill_all(nobody, camera, false);
    expect_found(nobody, {}, {});
}

}  // namespace
}  // namespace neuvv::test
