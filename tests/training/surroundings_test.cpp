// What stands around a performer: the images of it, and the first tree.
#include "training/mattes/surroundings.h"

#include <gtest/gtest.h>

#include <set>

#include "support/input_error.h"
#include "support/sphere_capture.h"
#include "training/capture/backdrop.h"
#include "training/data/layouts/formats.h"
#include "training/tree/carved_leaves.h"
#include "training/tree/surroundings_tree.h"

namespace neuvv::test {
namespace {

const training::Backdrop kRoom{glm::dvec3(-5), glm::dvec3(5), 1.0};

// What the cameras of a capture see of the room alone.
training::Dataset empty_room(const SphereCapture& capture) {
    training::Dataset dataset = sphere_dataset(capture);
    for (training::View& view : dataset.views)
        view.image.store(training::clean_plate(kRoom, dataset.cameras[view.camera]));
    return dataset;
}

// The data set as files: images without alpha, and mattes beside them.
training::Rig write_room(const std::filesystem::path& folder, const SphereCapture& capture) {
    const training::Dataset dataset = sphere_dataset(capture);
    write_capture(folder, dataset);
    std::filesystem::create_directories(folder / "mattes");
    for (const training::View& view : dataset.views) {
        media::Image image = training::clean_plate(kRoom, dataset.cameras[view.camera]), matte = image;
        const media::Image sphere = view.image.whole();
        for (size_t i = 0; i < image.rgba.size(); i += 4) {
            std::fill_n(&matte.rgba[i], 3, sphere.rgba[i + 3]);
            if (sphere.rgba[i + 3] > 0) std::copy_n(&sphere.rgba[i], 3, &image.rgba[i]);
        }
        media::write_png(folder / (view.name + ".png"), image);
        media::write_png(folder / "mattes" / (view.name + ".png"), matte);
    }
    return training::read_rig(folder, training::Split::kTrain);
}

// How many pixels differ from the room by more than two steps, and how many are known.
std::pair<size_t, size_t> compare_to_room(const training::View& view, const stage::Camera& camera) {
    const media::Image room = training::clean_plate(kRoom, camera);
    size_t different = 0, known = 0;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            if (view.ignores(x, y)) continue;
            ++known;
            for (int c = 0; c < 3; ++c)
                if (std::abs(int{view.image.at(x, y)[c]} - int{room.at(x, y)[c]}) > 2) {
                    ++different;
                    break;
                }
        }
    return {different, known};
}

TEST(Surroundings, AreWhatImagesShowOutsideTheMattes) {
    const TemporaryFolder folder;
    // The sphere moves by more than it is wide, so that each pixel shows the room at some time.
    const SphereCapture capture{.cameras = 5, .frames = 5, .size = 64, .radius_m = 0.3, .travel_m = 0.9};
    const training::Rig rig = write_room(folder.path, capture);
    ASSERT_TRUE(training::has_mattes(rig));
    const training::Dataset around = training::read_surroundings(rig, {}, 64);
    ASSERT_EQ(around.views.size(), 5u);
    EXPECT_EQ(around.times, std::vector<double>{0});
    for (const training::View& view : around.views) {
        const auto [different, known] = compare_to_room(view, around.cameras[view.camera]);
        EXPECT_EQ(different, 0u) << view.name;
        EXPECT_GT(known, size_t{64 * 64 * 9 / 10});
    }
}

TEST(Surroundings, WhatMattesAlwaysCoverIsIgnored) {
    const TemporaryFolder folder;
    const training::Rig rig = write_room(folder.path, {.cameras = 4, .frames = 1, .size = 64});
    const training::Dataset around = training::read_surroundings(rig, {}, 64);
    for (const training::View& view : around.views) {
        const auto [different, known] = compare_to_room(view, around.cameras[view.camera]);
        EXPECT_EQ(different, 0u);
        EXPECT_LT(known, size_t{64 * 64});
        EXPECT_TRUE(view.ignores(32, 32)) << "the sphere is in the middle";
    }
}

TEST(Surroundings, OfImagesThatWereCutOutThereAreNone) {
    const TemporaryFolder folder;
    write_capture(folder.path, sphere_dataset({.cameras = 4, .frames = 1}));
    const training::Rig rig = training::read_rig(folder.path, training::Split::kTrain);
    expect_input_error([&] { training::read_surroundings(rig, {}, 64); }, {folder.path.string(), "cut out"});
}

TEST(Surroundings, FirstLeavesLookAlikeFromTheNearestCamera) {
    const training::Dataset dataset = empty_room({.cameras = 6, .frames = 1, .size = 64});
    EXPECT_EQ(training::leaf_pixels_of(dataset, 64), 1);
    const double pixels = training::leaf_pixels_of(dataset, 32);
    EXPECT_EQ(pixels, 2);
    const voctree::VOctree tree = training::surroundings_tree(dataset, pixels, 0);
    EXPECT_EQ(voctree::defect_of(tree), "");
    EXPECT_GT(tree.leaf_count, 1000u);
    std::set<uint32_t> depths;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(tree)) {
        const double edge = static_cast<double>(tree.box_size.x) / (1u << position.depth);
        const glm::dvec3 at = training::hull_cell(tree, position, 0).centre;
        EXPECT_LE(edge, 16 * pixels * training::footprint_at(dataset, at));
        for (const stage::Camera& camera : dataset.cameras)
            EXPECT_GT(glm::length(glm::dvec3(camera.world_from_camera[3]) - at), 1.0) << "right before a camera";
        depths.insert(position.depth);
    }
    EXPECT_GE(depths.size(), 3u) << "far leaves are larger";
}

}  // namespace
}  // namespace neuvv::test
