// The first guess of colours, and the frames of times.
#include "training/tree/first_colours.h"

#include <gtest/gtest.h>

#include "support/edit_image.h"
#include "support/sphere_capture.h"

namespace neuvv::test {
namespace {

// The images of the sphere, in which each frame has a single colour.
training::Dataset painted(const SphereCapture& capture, const std::vector<std::array<uint8_t, 3>>& colours) {
    training::Dataset dataset = sphere_dataset(capture);
    for (training::View& view : dataset.views) {
        const auto& colour = colours[static_cast<size_t>(std::lround(view.time * (capture.frames - 1.0)))];
        edit_image(view, [&](media::Image& image) {
            for (uint32_t i = 0; i < capture.size * capture.size; ++i)
                std::copy(colour.begin(), colour.end(), &image.rgba[size_t{4} * i]);
        });
    }
    return dataset;
}

TEST(FirstColours, AreWhatTheCamerasSeeInAllowedInstants) {
    const SphereCapture capture;
    const training::Dataset dataset = painted(capture, {{200, 100, 50}, {20, 30, 40}, {20, 30, 40}});
    const std::vector<glm::vec3> positions = {glm::vec3(capture.centre(0)), glm::vec3(capture.centre(1)), {0, 5, 0}};
    const std::vector<glm::vec3> colours = training::first_colours(dataset, positions, {1, 6, 7});
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(colours[0][c],
                    media::linear_from_srgb_byte(std::array<uint8_t, 3>{200, 100, 50}[static_cast<size_t>(c)]), 1e-4);
        EXPECT_NEAR(colours[1][c],
                    media::linear_from_srgb_byte(std::array<uint8_t, 3>{20, 30, 40}[static_cast<size_t>(c)]), 1e-4);
        EXPECT_EQ(colours[2][c], 0.5f);  // no matte covers this position
    }
}

TEST(FrameOfTime, FewDigitsStillMeanAWholeFrame) {
    for (uint32_t frame = 0; frame < 24; ++frame) EXPECT_EQ(training::frame_of_time(frame / 23.0, 24), frame);
    EXPECT_EQ(training::frame_of_time(0.56522, 24), 13);
    EXPECT_NEAR(training::frame_of_time(0.5, 24), 11.5, 1e-12);
    EXPECT_EQ(training::frame_of_time(0.7, 1), 0);
}

}  // namespace
}  // namespace neuvv::test
