// Mattes of cameras that are looked at together, against known ones: a sphere in front of a wall.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/mattes/colour_cut.h"
#include "training/mattes/make_mattes.h"
#include "training/tree/hull_of_most.h"

namespace neuvv::test {
namespace {

using training::PixelMask;

const SphereCapture kRing{.cameras = 10, .frames = 5, .size = 96, .radius_m = 0.3, .travel_m = 0.75};

// A wall of one colour, with a little noise.
media::Image grey_wall(uint32_t side, uint64_t seed) {
    Random random(seed);
    media::Image image(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const auto value = static_cast<uint8_t>(98 + random.below(4));
            std::fill_n(image.at(x, y), 3, value);
            image.at(x, y)[3] = 255;
        }
    return image;
}

media::Image in_front_of(const media::Image& performer, media::Image background) {
    for (size_t i = 0; i < background.rgba.size(); i += 4)
        for (size_t c = 0; c < 3; ++c) {
            const double alpha = performer.rgba[i + 3] / 255.0;
            const double light = alpha * media::linear_from_srgb(performer.rgba[i + c] / 255.0) +
                                 (1 - alpha) * media::linear_from_srgb(background.rgba[i + c] / 255.0);
            background.rgba[i + c] = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(light)));
        }
    return background;
}

void paint(media::Image& image, uint32_t left, uint32_t top, uint32_t width, uint32_t height, uint8_t value) {
    for (uint32_t y = top; y < top + height; ++y)
        for (uint32_t x = left; x < left + width; ++x) std::fill_n(image.at(x, y), 3, value);
}

struct Figures : ::testing::Test {
    TemporaryFolder folder;
    training::Dataset truth = sphere_dataset(kRing);
    training::MatteJob job{.dataset = folder.path / "data", .output = folder.path / "data/mattes"};

    bool has_plates = false, are_swapped = false;  // cameras 3 and 7 have each other's images

    // `change` makes something wrong with the image of a view.
    template <typename Change>
    training::MatteSummary make(const Change& change) {
        training::Dataset opaque = truth;
        for (size_t i = 0; i < opaque.views.size(); ++i) {
            media::Image image = in_front_of(truth.views[i].image.whole(), grey_wall(kRing.size, i));
            change(opaque.views[i], image);
            opaque.views[i].image.store(image);
        }
        if (are_swapped) std::swap(opaque.cameras[3], opaque.cameras[7]);
        std::filesystem::create_directories(job.output);
        write_capture(job.dataset, opaque);
        if (has_plates)
            for (uint32_t camera = 0; camera < kRing.cameras; ++camera)
                media::write_png(job.dataset / fmt::format("plates/c{:02}.png", camera), grey_wall(kRing.size, 77));
        return training::make_mattes(job, {});
    }
    // The agreement of a camera's mattes where each camera is looked at alone, and where all are looked at together.
    template <typename Change>
    std::pair<double, double> alone_and_together(int camera, const Change& change) {
        job.alone = true;
        make(change);
        const double alone = iou(camera);
        job.alone = false;
        make(change);
        return {alone, iou(camera)};
    }
    // Intersection over union of all mattes, or of those of one camera, with the truth.
    double iou(int camera = -1) const {
        double both = 0, either = 0;
        for (const training::View& view : truth.views) {
            if (camera >= 0 && view.camera != static_cast<uint32_t>(camera)) continue;
            const media::Image matte = media::read_png(job.output / (view.name + ".png"));
            const media::Image image = view.image.whole();
            for (size_t i = 0; i < image.rgba.size(); i += 4) {
                const bool found = matte.rgba[i] > 127, is = image.rgba[i + 3] > 127;
                both += found && is;
                either += found || is;
            }
        }
        return both / either;
    }
};

const auto kNothing = [](const training::View&, media::Image&) {};

TEST_F(Figures, AreFoundWithoutPlates) {
    const training::MatteSummary made = make(kNothing);
    EXPECT_TRUE(made.alone.empty()) << made.alone.words();
    EXPECT_EQ(made.agreements.size(), 10u);
    EXPECT_GT(iou(), 0.9);
}

TEST_F(Figures, OfSwappedCamerasAreFoundAsIfSwappedBack) {
    std::filesystem::create_directories(job.dataset / "plates");
    has_plates = true;
    const double right = (make(kNothing), iou());
    are_swapped = true;
    const training::MatteSummary made = make(kNothing);
    ASSERT_EQ(made.swapped.size(), 1u);
    EXPECT_NE(made.swapped[0].find("c03"), std::string::npos) << made.swapped[0];
    EXPECT_NE(made.swapped[0].find("c07"), std::string::npos) << made.swapped[0];
    EXPECT_NEAR(iou(), right, 0.01);
}

// People in a doorway, whom one camera sees, differ from the background as much as the performer does.
TEST_F(Figures, WhatOneCameraAloneSeesIsLeftOut) {
    const auto doorway = [](const training::View& view, media::Image& image) {
        if (view.camera == 2) paint(image, view.name.back() % 2 ? 2 : 8, 4, 7, 22, 20);
    };
    const auto [alone, together] = alone_and_together(2, doorway);
    EXPECT_LT(alone, 0.85);
    EXPECT_GT(together, alone + 0.05);
}

// Cloth of the wall's colour differs from it nowhere: the other cameras know that it is there.
TEST_F(Figures, WhatOneCameraCannotTellFromTheWallIsTakenFromTheOthers) {
    const auto camouflage = [&](const training::View& view, media::Image& image) {
        if (view.camera != 4) return;
        const media::Image wall = grey_wall(kRing.size, 99), performer = view.image.whole();
        uint32_t left = kRing.size, right = 0, top = kRing.size, bottom = 0;
        for (uint32_t y = 0; y < kRing.size; ++y)
            for (uint32_t x = 0; x < kRing.size; ++x)
                if (performer.at(x, y)[3] > 0) {
                    left = std::min(left, x);
                    right = std::max(right, x);
                    top = std::min(top, y);
                    bottom = std::max(bottom, y);
                }
        for (uint32_t y = top; y <= bottom; ++y)  // the middle third of the sphere, from one edge to the other
            for (uint32_t x = left + (right - left) / 3; x < left + 2 * (right - left) / 3; ++x)
                std::copy_n(wall.at(x, y), 4, image.at(x, y));
    };
    std::filesystem::create_directories(job.dataset / "plates");
    has_plates = true;
    const auto [alone, together] = alone_and_together(4, camouflage);
    EXPECT_LT(alone, 0.75);
    EXPECT_GT(together, alone + 0.1);
}

TEST_F(Figures, OfFewCamerasAreDifferences) {
    truth.views.erase(
        std::remove_if(truth.views.begin(), truth.views.end(), [](const training::View& v) { return v.camera > 3; }),
        truth.views.end());
    truth.cameras.resize(4);
    truth.plates.resize(4);
    const training::MatteSummary made = make(kNothing);
    EXPECT_NE(made.alone.words().find("4 cameras are too few"), std::string::npos) << made.alone.words();
    EXPECT_TRUE(made.agreements.empty());
    EXPECT_GT(iou(), 0.9);
}

TEST_F(Figures, APlateOfAnotherPlaceIsNotUsed) {
    std::filesystem::create_directories(job.dataset / "plates");
    media::Image green(kRing.size, kRing.size), checks = grey_wall(kRing.size, 5);
    for (size_t i = 0; i < green.rgba.size(); i += 4) {
        green.rgba[i + 1] = 255;
        green.rgba[i + 3] = 255;
    }
    media::write_png(job.dataset / "plates/c03.png", green);
    media::write_png(job.dataset / "plates/c05.png", checks);
    const training::MatteSummary made = make(kNothing);
    ASSERT_EQ(made.wrong_plates.size(), 1u);
    EXPECT_NE(made.wrong_plates[0].words().find("c03.png"), std::string::npos) << made.wrong_plates[0].words();
    EXPECT_EQ(made.cameras_with_plate, 1u);
    EXPECT_GT(iou(3), 0.85);
}

TEST(HullOfMost, OneCameraMayBeWrong) {
    const SphereCapture ring{.cameras = 20, .frames = 1, .size = 64};
    const training::Dataset truth = sphere_dataset(ring);
    std::vector<training::CameraMask> cameras;
    for (const training::View& view : truth.views) {
        PixelMask mask(ring.size, ring.size);
        const media::Image image = view.image.whole();
        for (size_t i = 0; i < mask.size(); ++i) mask.set[i] = view.camera != 7 && image.rgba[4 * i + 3] > 127;
        cameras.push_back({&truth.cameras[view.camera], mask});
    }
    const std::pair<glm::dvec3, glm::dvec3> box{glm::dvec3(-1), glm::dvec3(1)};
    const auto agreement = [&](double dissent) {
        const std::vector<PixelMask> hull =
            training::hull_of_most(cameras, box, {.dissent = dissent, .divisions = 3, .by_centres = true});
        const media::Image image = truth.views[7].image.whole();
        double both = 0, either = 0;
        for (size_t i = 0; i < hull[7].size(); ++i) {
            both += hull[7][i] && image.rgba[4 * i + 3] > 127;
            either += hull[7][i] || image.rgba[4 * i + 3] > 127;
        }
        return both / either;
    };
    EXPECT_GT(agreement(0.06), 0.85);
    cameras.resize(7);
    cameras[0].mask = PixelMask(ring.size, ring.size);
    for (const PixelMask& seen : training::hull_of_most(cameras, box, {.dissent = 0.06, .divisions = 3}))
        EXPECT_EQ(std::ranges::count(seen.set, 1), 0) << "of seven cameras, all must agree";
}

TEST(ColourCut, MovesABorderToWhereColoursChange) {
    media::Image image(80, 60);
    for (uint32_t y = 0; y < 60; ++y)
        for (uint32_t x = 0; x < 80; ++x) {
            const bool inside = x >= 25 && x < 55 && y >= 15 && y < 45;
            const uint8_t colour[3] = {static_cast<uint8_t>(inside ? 180 : 40), 60,
                                       static_cast<uint8_t>((inside ? 40 : 170) + (x * 7 + y * 3) % 9)};
            std::copy_n(colour, 3, image.at(x, y));
        }
    training::FigureBounds bounds{PixelMask(80, 60), PixelMask(80, 60), PixelMask(80, 60)};
    for (size_t i = 0; i < bounds.sure.size(); ++i) {
        const size_t x = i % 80, y = i / 80;
        bounds.sure.set[i] = x >= 35 && x < 45 && y >= 25 && y < 35;
        bounds.probable.set[i] = x >= 21 && x < 52 && y >= 18 && y < 47;  // off by a few pixels
        bounds.possible.set[i] = x >= 15 && x < 65 && y >= 5 && y < 55;
    }
    const PixelMask figure = training::cut_by_colour(image, bounds);
    for (size_t i = 0; i < figure.size(); ++i) {
        const size_t x = i % 80, y = i / 80;
        ASSERT_EQ(figure[i], x >= 25 && x < 55 && y >= 15 && y < 45) << x << ", " << y;
    }
}

}  // namespace
}  // namespace neuvv::test
