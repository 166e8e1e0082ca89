// Whole runs that learn the colours of cameras, on captures whose images have gains that differ from camera to camera.
#include "training/step/camera_colour.h"

#include <gtest/gtest.h>

#include <array>

#include "support/edit_image.h"
#include "support/gpu_test.h"
#include "support/performer_capture.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/run/checkpoint.h"
#include "training/run/train.h"
#include "training/step/colour_findings.h"

namespace neuvv::test {
namespace {

using CameraColourTest = GpuTest;

bool to_the_end(const training::TrainProgress&) {
    return true;
}

// A data set with gains of −15 % to 15 % of each camera and channel, whose means over the cameras are 1.
training::Dataset spoilt(training::Dataset dataset, std::vector<glm::vec3>& gains) {
    const auto cameras = static_cast<uint32_t>(dataset.cameras.size());
    gains.assign(cameras, glm::vec3(1));
    const std::array<uint32_t, 3> strides{5, 7, 11};  // prime to 12 and 13 cameras, so that each gain occurs once
    for (uint32_t i = 0; i < cameras; ++i)
        for (int c = 0; c < 3; ++c) {
            const uint32_t place = i * strides[static_cast<size_t>(c)] % cameras;
            gains[i][c] += 0.15f * (2 * static_cast<float>(place) / static_cast<float>(cameras - 1) - 1);
        }
    for (training::View& view : dataset.views)
        edit_image(view, [&](media::Image& image) {
            for (size_t i = 0; i < image.rgba.size(); ++i) {
                uint8_t& value = image.rgba[i];
                if (i % 4 == 3) continue;
                const float light = media::linear_from_srgb_byte(value) * gains[view.camera][static_cast<int>(i % 4)];
                value = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(std::min(light, 1.0f))));
            }
        });
    return dataset;
}

double mean_gain_error(const std::vector<CameraColour>& found, const std::vector<glm::vec3>& truth) {
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i)
        sum += double{glm::dot(glm::abs(training::gains(found[i]) - truth[i]), glm::vec3(1.0f / 3))};
    return sum / static_cast<double>(truth.size());
}

// The images of the second camera are black, so that every step asks for lower gains.
TEST(CameraColours, StayWithinBounds) {
    training::CameraColours colours(2, 1, {.colour = true});
    training::Batch batch;
    batch.tiles = {Tile{1, 0, 0, 0}};
    std::vector<CameraColour> gradients(1, CameraColour{});
    const std::vector<stage::Camera> cameras(2, sphere_camera({}, 0));
    for (glm::vec4& row : gradients[0].rows) row = glm::vec4(10);
    for (uint64_t step = 1; step <= 500; ++step) colours.learn(batch, cameras, gradients.data(), 0.01f, step);
    for (const CameraColour& colour : colours.values) EXPECT_TRUE(training::is_bounded(colour));
    EXPECT_EQ(training::gains(colours.values[1]), glm::vec3(0.5f));
    const CameraColour back = training::inverse(colours.values[1]);
    const glm::vec4 light(0.2f, 0.4f, 0.6f, 1);
    const glm::vec4 seen(training::seen(colours.values[1], light), 1);
    EXPECT_LT(glm::distance(training::seen(back, seen), glm::vec3(light)), 1e-5f);
}

TEST_F(CameraColourTest, FindsTheGainsOfCameras) {
    const TemporaryFolder folder;
    std::vector<glm::vec3> gains;
    training::Dataset dataset = spoilt(performer_capture(folder.path), gains);
    training::TrainSettings settings;
    settings.steps = 200;
    settings.shape.hh_degree = 1;
    settings.refine.colour = true;
    const training::TrainProgress last =
        training::train(device(), dataset, settings, folder.path / "performer.nvv", to_the_end);
    const std::vector<CameraColour> neutral(gains.size(), training::kNeutralColour);
    EXPECT_GT(mean_gain_error(neutral, gains), 0.07);
    EXPECT_LT(mean_gain_error(last.colours.values, gains), 0.035);  // 0.023 measured
    glm::vec3 sum(0);
    for (const CameraColour& colour : last.colours.values) sum += training::gains(colour);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / static_cast<float>(gains.size()), 1, 1e-5);
}

// Gains are learnt on where cameras differ; exposures, which do not, are as they were.
TEST_F(CameraColourTest, OnlyWhatIsWorthItIsLearntOn) {
    const TemporaryFolder folder;
    std::vector<glm::vec3> gains;
    training::Dataset clean = performer_capture(folder.path), differing = spoilt(clean, gains);
    training::TrainSettings settings;
    settings.steps = 200;
    settings.shape.hh_degree = 1;
    settings.refine = {.colour = true, .exposure = true};
    settings.try_colours = true;
    const auto colours_of = [&](training::Dataset& dataset) {
        return training::train(device(), dataset, settings, "", to_the_end).colours;
    };
    EXPECT_TRUE(colours_of(clean).empty());
    const training::CameraColours found = colours_of(differing);
    ASSERT_EQ(found.cameras(), gains.size());
    EXPECT_FALSE(found.first.empty());
    EXPECT_LT(mean_gain_error(found.values, gains), 0.035);
    EXPECT_EQ(found.frames(), 0u);
}

// One of 14 cameras is 15 % brighter in its one image: half of that lies in its exposure, half in its gains.
TEST(CameraColours, WhatExposuresHaveInCommonIsAGain) {
    training::CameraColours colours(14, 1, {.colour = true, .exposure = true});
    for (float& second : colours.exposures.second) second = 1;
    for (glm::vec4& row : colours.values[3].rows) row *= std::sqrt(1.15f);
    colours.exposures.values[3] = 0.5f * std::log(1.15f);
    EXPECT_FALSE(training::worthwhile(colours).any());
    colours.join_exposures();
    EXPECT_NEAR(training::gains(colours.values[3]).g, 1.15f - 0.15f / 14, 1e-5f);
    EXPECT_EQ(colours.exposures.values[3], 0);
    EXPECT_TRUE(training::worthwhile(colours).colour);
    EXPECT_FALSE(training::worthwhile(colours).exposure);
}

// A run that is stopped before it chose goes on trying, and then chooses as one that was not.
TEST_F(CameraColourTest, AResumedRunChoosesLater) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    training::Dataset dataset = sphere_dataset({});
    training::TrainSettings settings;
    settings.steps = 40;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 128;
    settings.refine = {.colour = true, .exposure = true};
    settings.try_colours = true;
    settings.between_steps = [](const training::BetweenSteps& now) { return now.fraction < 0.1; };
    const training::TrainProgress first = training::train(device(), dataset, settings, nvv, to_the_end);
    EXPECT_EQ(first.colour_choice, training::ColourChoice::kOpen);
    EXPECT_EQ(training::load_checkpoint(nvv).colours.cameras(), dataset.cameras.size());
    settings.between_steps = {};
    settings.resume = true;
    settings.try_colours = false;  // the run does what it did
    const training::TrainProgress last = training::train(device(), dataset, settings, nvv, to_the_end);
    EXPECT_EQ(last.colour_choice, training::ColourChoice::kChosen);
    EXPECT_TRUE(last.colours.empty());
}

TEST(CameraColours, KeepsWhatIsNamed) {
    training::CameraColours colours(2, 3, {.colour = true, .exposure = true, .vignetting = true});
    colours.values[1].rows[0].r = 1.25f;
    colours.exposures.values[4] = 0.125f;
    colours.keep({.exposure = true, .vignetting = true});
    EXPECT_EQ(training::gains(colours.values[1]), glm::vec3(1));
    EXPECT_TRUE(colours.first.empty());
    EXPECT_EQ(colours.exposures.values[4], 0.125f);
    EXPECT_EQ(colours.vignettes.values.size(), 4u);
    colours.keep({});
    EXPECT_TRUE(colours.empty());
}

TEST_F(CameraColourTest, AResumedRunKeepsItsColours) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    std::vector<glm::vec3> gains;
    training::Dataset dataset = spoilt(sphere_dataset({}), gains);
    training::TrainSettings settings;
    settings.steps = 20;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 128;
    settings.refine.colour = true;
    const training::TrainProgress first = training::train(device(), dataset, settings, nvv, to_the_end);
    const training::CameraColours saved = training::load_checkpoint(nvv).colours;
    ASSERT_EQ(saved.values.size(), dataset.cameras.size());
    for (size_t i = 0; i < saved.values.size(); ++i)
        for (int row = 0; row < 3; ++row) EXPECT_EQ(saved.values[i].rows[row], first.colours.values[i].rows[row]);
    EXPECT_GT(saved.second[0].rows[0].r, 0);
    settings.resume = true;
    settings.refine.colour = false;  // a resumed run keeps refining
    EXPECT_EQ(training::train(device(), dataset, settings, nvv, to_the_end).colours.values[3].rows[1],
              first.colours.values[3].rows[1]);
    settings.steps = 21;
    const training::TrainProgress next = training::train(device(), dataset, settings, nvv, to_the_end);
    ASSERT_EQ(next.colours.cameras(), first.colours.cameras());
    EXPECT_NE(next.colours.values[3].rows[1], first.colours.values[3].rows[1]);
}

// The derivatives of what images show by exposure and vignette, against central differences of a tile's colour.
TEST(CameraColours, MovesExposuresAndVignettesDownhill) {
    Random random(9);
    const std::vector<stage::Camera> cameras{sphere_camera({}, 0), sphere_camera({}, 1)};
    training::CameraColours colours(2, 3, {.colour = true, .exposure = true, .vignetting = true});
    for (float& value : colours.exposures.values) value = static_cast<float>(random.uniform(-0.2, 0.2));
    for (float& value : colours.vignettes.values) value = static_cast<float>(random.uniform(-0.2, 0.2));
    training::Batch batch;
    batch.frame = 2;
    for (uint32_t i = 0; i < 6; ++i) batch.tiles.push_back(Tile{i % 2, 8 * (i % 3), 8 * (i / 3), 0});
    std::vector<CameraColour> gradients(batch.tiles.size());
    for (CameraColour& gradient : gradients)
        for (glm::vec4& row : gradient.rows)
            for (int i = 0; i < 4; ++i) row[i] = static_cast<float>(random.bell());
    // What the loss would be if it were linear in the tiles' colours.
    const auto loss = [&](const training::CameraColours& at) {
        double sum = 0;
        for (size_t tile = 0; tile < batch.tiles.size(); ++tile) {
            const CameraColour colour = at.of_tile(batch, tile, cameras[batch.tiles[tile].camera]);
            for (int row = 0; row < 3; ++row) sum += double{glm::dot(colour.rows[row], gradients[tile].rows[row])};
        }
        return sum;
    };
    training::CameraColours next = colours;
    next.learn(batch, cameras, gradients.data(), 1e-3f, 1);
    training::CameraColours centred = colours;  // what a step without a rate makes of them
    centred.learn(batch, cameras, gradients.data(), 0, 1);
    const auto expect_derivative = [&](auto member, size_t i) {
        training::CameraColours more = colours, less = colours;
        constexpr float kStep = 1e-2f;
        (more.*member).values[i] += kStep;
        (less.*member).values[i] -= kStep;
        const double slope = (loss(more) - loss(less)) / (2 * double{kStep});
        ASSERT_GT(std::abs(slope), 0.01);
        EXPECT_NEAR((next.*member).first[i] / 0.1f, slope, 0.01 * std::abs(slope)) << i;  // the mean of one gradient
    };
    for (size_t i = 0; i < 4; ++i) expect_derivative(&training::CameraColours::vignettes, i);
    for (const size_t camera : {0u, 1u}) expect_derivative(&training::CameraColours::exposures, camera * 3 + 2);
    EXPECT_NEAR(next.exposures.values[2] + next.exposures.values[5], 0, 1e-6);
    EXPECT_NEAR(next.vignettes.values[1] + next.vignettes.values[3], 0, 1e-6);
    EXPECT_LT(loss(next), loss(centred));
    EXPECT_EQ(next.exposures.values[0], colours.exposures.values[0]);  // of another frame
}

// Camera 1 has no image of the frame: what the others show is not weighed against it.
TEST(CameraColours, ImagesThatAreMissingDoNotCount) {
    const std::vector<stage::Camera> cameras(3, sphere_camera({}, 0));
    training::CameraColours colours(3, 1, {.exposure = true});
    training::Batch batch;
    batch.tiles = {Tile{0, 0, 0, 0}, Tile{2, 0, 0, 0}};
    std::vector<CameraColour> gradients(2, CameraColour{});
    gradients[0].rows[0].r = -1;
    gradients[1].rows[0].r = 1;
    for (uint64_t step = 1; step <= 20; ++step) colours.learn(batch, cameras, gradients.data(), 0.01f, step);
    EXPECT_GT(colours.exposures.values[0], 0.1f);
    EXPECT_NEAR(colours.exposures.values[0] + colours.exposures.values[2], 0, 1e-6);
    EXPECT_EQ(colours.exposures.values[1], 0);
}

TEST(CameraColours, ATileShowsExposureAndVignette) {
    const stage::Camera camera = sphere_camera({.size = 64}, 0);
    training::CameraColours colours(1, 2, {.exposure = true, .vignetting = true});
    colours.exposures.values[1] = std::log(1.5f);
    colours.vignettes.values = {-0.4f, 0.1f};
    training::Batch batch;
    batch.frame = 1;
    batch.tiles = {Tile{0, 28, 28, 0}, Tile{0, 0, 0, 0}};
    const float corner = static_cast<float>(28 * 28) / (32 * 32);  // the tile's centre is 28 pixels from the image's
    EXPECT_NEAR(colours.of_tile(batch, 0, camera).rows[1].g, 1.5f, 1e-6f);
    EXPECT_NEAR(colours.of_tile(batch, 1, camera).rows[1].g, 1.5f * (1 - 0.4f * corner + 0.1f * corner * corner),
                1e-6f);
}

// Images whose exposure differs by camera and frame.
TEST_F(CameraColourTest, FindsTheExposuresOfImages) {
    const TemporaryFolder folder;
    training::Dataset dataset = performer_capture(folder.path);
    const size_t frames = dataset.times.size(), cameras = dataset.cameras.size();
    std::vector<float> truth(cameras * frames);
    Random random(4);
    for (size_t frame = 0; frame < frames; ++frame) {
        float mean = 0;
        for (size_t camera = 0; camera < cameras; ++camera) {
            truth[camera * frames + frame] = static_cast<float>(random.uniform(-0.15, 0.15));
            mean += truth[camera * frames + frame] / static_cast<float>(cameras);
        }
        for (size_t camera = 0; camera < cameras; ++camera) truth[camera * frames + frame] -= mean;
    }
    for (training::View& view : dataset.views) {
        const auto frame = static_cast<size_t>(std::ranges::find(dataset.times, view.time) - dataset.times.begin());
        const float gain = std::exp(truth[view.camera * frames + frame]);
        edit_image(view, [&](media::Image& image) {
            for (size_t i = 0; i < image.rgba.size(); ++i)
                if (i % 4 != 3) {
                    const float light = media::linear_from_srgb_byte(image.rgba[i]) * gain;
                    image.rgba[i] =
                        static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(std::min(light, 1.0f))));
                }
        });
    }
    training::TrainSettings settings;
    settings.steps = 120;
    settings.refine.exposure = true;
    const training::TrainProgress last =
        training::train(device(), dataset, settings, folder.path / "performer.nvv", to_the_end);
    double before = 0, after = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        before += std::abs(double{truth[i]}) / static_cast<double>(truth.size());
        after +=
            std::abs(double{last.colours.exposures.values[i]} - double{truth[i]}) / static_cast<double>(truth.size());
    }
    EXPECT_GT(before, 0.06);
    EXPECT_LT(after, 0.5 * before);
    EXPECT_EQ(last.colours.values[3].rows[1], training::kNeutralColour.rows[1]);  // colour itself was not asked for
}

}  // namespace
}  // namespace neuvv::test
