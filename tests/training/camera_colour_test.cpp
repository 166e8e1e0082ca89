// Whole runs that learn the colours of cameras, on captures whose images have gains that differ from camera to camera.
#include "training/camera_colour.h"

#include <gtest/gtest.h>

#include <array>

#include "support/child_process.h"
#include "support/edit_image.h"
#include "support/gpu_test.h"
#include "support/sphere_capture.h"
#include "training/train.h"

namespace neuvv::test {
namespace {

using CameraColourTest = GpuTest;

bool to_the_end(const training::TrainProgress&) {
    return true;
}

// A small capture of the performer. On the sphere, few gains are found (RESULTS.md).
training::Dataset performer_capture(const std::filesystem::path& folder) {
    const std::string model = std::string(NEUVV_SOURCE_DIR) + "/tools/performer/performer.glb";
    ChildProcess capture(
        {NEUVV_PROGRAM, "capture", model, "-o", folder.string(), "--cameras", "14", "--frames", "2", "--size", "96x96"},
        folder / "log.txt");
    EXPECT_EQ(capture.wait(), 0) << read_text(folder / "log.txt");
    return training::load_dataset(folder, training::Split::kTrain);
}

// A data set with gains of −15 % to 15 % of each camera and channel, whose means over the cameras are 1.
training::Dataset spoilt(training::Dataset dataset, std::vector<glm::vec3>& gains) {
    const auto cameras = static_cast<uint32_t>(dataset.cameras.size());
    gains.assign(cameras, glm::vec3(1));
    const std::array<uint32_t, 3> strides{5, 7, 11};  // prime to 12 and 13 cameras, so that each gain occurs once
    for (uint32_t i = 0; i < cameras; i++)
        for (int c = 0; c < 3; c++) {
            const uint32_t place = i * strides[static_cast<size_t>(c)] % cameras;
            gains[i][c] += 0.15f * (2 * static_cast<float>(place) / static_cast<float>(cameras - 1) - 1);
        }
    for (training::View& view : dataset.views)
        edit_image(view, [&](media::Image& image) {
            for (size_t i = 0; i < image.rgba.size(); i++) {
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
    for (size_t i = 0; i < truth.size(); i++)
        sum += double{glm::dot(glm::abs(training::gains(found[i]) - truth[i]), glm::vec3(1.0f / 3))};
    return sum / static_cast<double>(truth.size());
}

// The images of the second camera are black, so that every step asks for lower gains.
TEST(CameraColours, StayWithinBounds) {
    training::CameraColours colours(2);
    training::Batch batch;
    batch.tiles = {Tile{1, 0, 0, 0}};
    std::vector<CameraColour> gradients(1, CameraColour{});
    for (glm::vec4& row : gradients[0].rows) row = glm::vec4(10);
    for (uint64_t step = 1; step <= 500; step++) colours.learn(batch, gradients.data(), 0.01f, step);
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
    const training::Dataset dataset = spoilt(performer_capture(folder.path), gains);
    training::TrainSettings settings;
    settings.steps = 200;
    settings.shape.hh_degree = 1;
    settings.refine_colour = true;
    const training::TrainProgress last =
        training::train(device(), dataset, settings, folder.path / "performer.nvv", to_the_end);
    const std::vector<CameraColour> neutral(gains.size(), training::kNeutralColour);
    EXPECT_GT(mean_gain_error(neutral, gains), 0.07);
    EXPECT_LT(mean_gain_error(last.colours, gains), 0.035);  // 0.023 measured
    glm::vec3 sum(0);
    for (const CameraColour& colour : last.colours) sum += training::gains(colour);
    for (int c = 0; c < 3; c++) EXPECT_NEAR(sum[c] / static_cast<float>(gains.size()), 1, 1e-5);
}

TEST_F(CameraColourTest, AResumedRunKeepsItsColours) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "sphere.nvv";
    std::vector<glm::vec3> gains;
    const training::Dataset dataset = spoilt(sphere_dataset({}), gains);
    training::TrainSettings settings;
    settings.steps = 20;
    settings.shape = {.resolution = 40, .bases = 3, .hh_degree = 1};
    settings.tiles_per_step = 128;
    settings.refine_colour = true;
    const training::TrainProgress first = training::train(device(), dataset, settings, nvv, to_the_end);
    const training::CameraColours saved = training::load_checkpoint(nvv).colours;
    ASSERT_EQ(saved.values.size(), dataset.cameras.size());
    for (size_t i = 0; i < saved.values.size(); i++)
        for (int row = 0; row < 3; row++) EXPECT_EQ(saved.values[i].rows[row], first.colours[i].rows[row]);
    EXPECT_GT(saved.second[0].rows[0].r, 0);
    settings.resume = true;
    settings.refine_colour = false;  // a resumed run keeps refining
    EXPECT_EQ(training::train(device(), dataset, settings, nvv, to_the_end).colours[3].rows[1],
              first.colours[3].rows[1]);
    settings.steps = 21;
    const training::TrainProgress next = training::train(device(), dataset, settings, nvv, to_the_end);
    ASSERT_EQ(next.colours.size(), first.colours.size());
    EXPECT_NE(next.colours[3].rows[1], first.colours[3].rows[1]);
}

}  // namespace
}  // namespace neuvv::test
