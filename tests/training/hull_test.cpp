// Carving keeps matter and removes what no matte allows.
#include "training/tree/hull.h"
#include "training/tree/hull_box.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/edit_image.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"

namespace neuvv::test {
namespace {

bool allowed(const std::vector<uint32_t>& bits, size_t words, size_t cell, uint32_t frame) {
    return bits[cell * words + frame / 32] >> frame % 32 & 1;
}

// Cells of a grid over [−1, 1]³ that lie entirely inside every image.
std::vector<training::HullCell> grid(uint32_t side) {
    std::vector<training::HullCell> cells;
    const float edge = 2.0f / static_cast<float>(side);
    for (uint32_t i = 0; i < side * side * side; ++i) {
        const glm::vec3 at(i % side, i / side % side, i / side / side);
        cells.push_back({edge * (at + 0.5f) - 1.0f, edge * 0.8660254f});
    }
    return cells;
}

TEST(Hull, NeverCarvesMatterAndCarvesMostOfTheRest) {
    const SphereCapture capture;
    const training::Dataset dataset = sphere_dataset(capture);
    const std::vector<training::HullCell> cells = grid(24);
    const std::vector<uint32_t> bits = training::carve(dataset, cells);
    ASSERT_EQ(training::hull_words(dataset), 1u);
    ASSERT_EQ(bits.size(), cells.size());
    for (uint32_t frame = 0; frame < capture.frames; ++frame) {
        size_t matter = 0, empty = 0, empty_kept = 0;
        for (size_t i = 0; i < cells.size(); ++i) {
            const double distance = glm::length(glm::dvec3(cells[i].centre) - capture.centre(capture.time(frame)));
            const double radius = cells[i].radius;
            if (distance < capture.radius_m + 0.5 * radius) {
                ++matter;
                EXPECT_TRUE(allowed(bits, 1, i, frame)) << "frame " << frame << ", cell " << i;
            } else if (distance > capture.radius_m + 3 * radius) {
                ++empty;
                empty_kept += allowed(bits, 1, i, frame) ? 1 : 0;
            }
        }
        EXPECT_GT(matter, 300u);
        EXPECT_LT(static_cast<double>(empty_kept), 0.02 * static_cast<double>(empty));
    }
}

// Balls of all sizes that overlap the sphere by little more than a pixel: the rectangles around their images must not
// be too small.
TEST(Hull, KeepsABallThatBarelyTouchesMatter) {
    const SphereCapture capture{
        .cameras = 4, .frames = 1, .size = 200, .radius_m = 0.3, .travel_m = 0, .distance_m = 2.5};
    const training::Dataset dataset = sphere_dataset(capture);
    const double pixel_m = capture.distance_m / dataset.cameras[0].fx;
    Random random(4);
    std::vector<training::HullCell> touching;
    for (int i = 0; i < 3000; ++i) {
        const glm::dvec3 away = glm::normalize(glm::dvec3(random.bell(), random.bell(), random.bell()));
        const double radius = random.uniform(0.03, 0.25);
        const double distance = capture.radius_m + radius - 1.5 * pixel_m;
        touching.push_back({glm::vec3(capture.centre(0) + distance * away), static_cast<float>(radius)});
    }
    const std::vector<uint32_t> bits = training::carve(dataset, touching);
    EXPECT_EQ(std::count(bits.begin(), bits.end(), 0u), 0);
}

TEST(Hull, FramesBeyondThirtyTwoHaveTheirOwnBits) {
    const SphereCapture capture{.cameras = 6, .frames = 40, .size = 24, .radius_m = 0.25, .travel_m = 0.6};
    const training::Dataset dataset = sphere_dataset(capture);
    ASSERT_EQ(training::hull_words(dataset), 2u);
    for (const uint32_t seen : {0u, 31u, 32u, 39u}) {
        const std::vector<uint32_t> bits =
            training::carve(dataset, {{glm::vec3(capture.centre(capture.time(seen))), 0.05f}});
        ASSERT_EQ(bits.size(), 2u);
        for (uint32_t frame = 0; frame < capture.frames; ++frame) {
            const double moved = glm::length(capture.centre(capture.time(frame)) - capture.centre(capture.time(seen)));
            if (moved < capture.radius_m) {
                EXPECT_TRUE(allowed(bits, 2, 0, frame)) << seen << ' ' << frame;
            }
            if (moved > 3 * capture.radius_m) {
                EXPECT_FALSE(allowed(bits, 2, 0, frame)) << seen << ' ' << frame;
            }
        }
        EXPECT_EQ(bits[1] >> 8, 0u) << "bits beyond the last frame";
    }
}

TEST(Hull, NeedsTwoCamerasThatSeeTheCell) {
    const SphereCapture capture{.cameras = 2, .frames = 1};
    training::Dataset dataset = sphere_dataset(capture);
    const std::vector<training::HullCell> centre = {{glm::vec3(capture.centre(0)), 0.1f}};
    EXPECT_EQ(training::carve(dataset, centre)[0], 1u);
    training::Dataset turned = dataset;  // the second camera looks away
    turned.cameras[1].world_from_camera[0] *= -1;
    turned.cameras[1].world_from_camera[2] *= -1;
    EXPECT_EQ(training::carve(turned, centre)[0], 0u);
    dataset.views.pop_back();  // a single image is left and decides
    EXPECT_EQ(training::carve(dataset, centre)[0], 1u);
}

// An image says nothing about a cell that lies half outside it.
TEST(Hull, ACellAtTheImagesEdgeIsNotCarvedByIt) {
    const SphereCapture capture{.cameras = 3, .frames = 1};
    training::Dataset dataset = sphere_dataset(capture);
    const std::vector<training::HullCell> centre = {{glm::vec3(capture.centre(0)), 0.1f}};
    clear_image(dataset.views[2]);
    EXPECT_EQ(training::carve(dataset, centre)[0], 0u) << "the third camera sees background there";
    dataset.cameras[2].cx += capture.size / 2.0;
    EXPECT_EQ(training::carve(dataset, centre)[0], 1u);
}

// Cells of a coarse grid may be larger than close-ups; the matter that these show in them must not be lost.
TEST(Hull, KeepsACellThatExceedsAllImages) {
    const SphereCapture capture{.cameras = 3, .frames = 1, .radius_m = 0.1};
    training::Dataset dataset = sphere_dataset(capture);
    const training::HullCell cell{glm::vec3(capture.centre(0)), 1.0f};
    for (stage::Camera& camera : dataset.cameras) camera.fx = camera.fy = 3.0 * camera.width;
    EXPECT_EQ(training::carve(dataset, {cell})[0], 1u);
    for (training::View& view : dataset.views) clear_image(view);
    EXPECT_EQ(training::carve(dataset, {cell})[0], 0u) << "nobody sees matter";
}

TEST(Hull, BoxEnclosesTheSphereInAllFrames) {
    SphereCapture capture;
    training::Dataset dataset = sphere_dataset(capture);
    for (const bool given : {false, true}) {
        if (given) dataset.box = {{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}};
        const auto [low, high] = training::hull_box(dataset);
        const glm::dvec3 amplitude(capture.travel_m, 0, 0), radius(capture.radius_m), centre = capture.centre(0.5);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(low[axis], (centre - amplitude - radius)[axis]);
            EXPECT_GE(high[axis], (centre + amplitude + radius)[axis]);
            EXPECT_LT(high[axis] - low[axis], 1.5 * 2 * (amplitude + radius)[axis]);
        }
    }
}

TEST(Hull, RefusesMattesThatFitNowhere) {
    training::Dataset dataset = sphere_dataset({.frames = 1});
    training::Dataset mirrored = dataset;
    for (training::View& view : mirrored.views)  // mattes at the left edge for some cameras, at the right for others
        edit_image(view, [&](media::Image& image) {
            for (uint32_t y = 0; y < image.height; ++y)
                for (uint32_t x = 0; x < image.width; ++x)
                    image.at(x, y)[3] = (view.camera % 2 ? x < 3 : x + 3 >= image.width) ? 255 : 0;
        });
    for (training::View& view : dataset.views) clear_image(view);
    for (const training::Dataset* bad : {&dataset, &mirrored})
        expect_input_error([&] { training::hull_box(*bad); }, {"sphere", "mattes", "alpha"});
}

TEST(Hull, RefusesCamerasThatAllLookTheSameWay) {
    training::Dataset dataset = sphere_dataset({.frames = 1});
    for (size_t i = 0; i < dataset.cameras.size(); ++i) {
        dataset.cameras[i] = dataset.cameras[0];
        dataset.cameras[i].world_from_camera[3].y += 0.1 * static_cast<double>(i);
    }
    expect_input_error([&] { training::hull_box(dataset); }, {"sphere", "aabb"});
}

// The image of one camera is empty, but ignored, so matter must stay. Were it not ignored, everything would be carved.
TEST(Hull, IgnoredPixelsDoNotCarve) {
    const SphereCapture capture{.frames = 1};
    const training::Dataset truth = sphere_dataset(capture);
    training::Dataset dataset = truth;
    training::View& view = dataset.views[2];
    clear_image(view);
    const std::vector<training::HullCell> cells = grid(16);
    const auto count = [](const std::vector<uint32_t>& bits) {
        return std::count_if(bits.begin(), bits.end(), [](uint32_t word) { return word != 0; });
    };
    EXPECT_EQ(count(training::carve(dataset, cells)), 0);
    view.ignored.resize(size_t{capture.size} * capture.size, true);
    const std::vector<uint32_t> believed = training::carve(truth, cells), kept = training::carve(dataset, cells);
    EXPECT_GT(count(believed), 0);
    for (size_t i = 0; i < cells.size(); ++i) EXPECT_TRUE(kept[i] || !believed[i]) << i;
    EXPECT_LT(count(kept), static_cast<ptrdiff_t>(cells.size()) / 4) << "the others still carve";
}

}  // namespace
}  // namespace neuvv::test
