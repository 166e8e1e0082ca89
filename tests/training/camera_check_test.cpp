// The check of a rig's cameras: what it does to the rig, and what it says.
#include "training/tree/camera_check.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "support/armed_figure.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"

namespace neuvv::test {
namespace {

struct CameraCheck : testing::Test {
    TemporaryFolder folder;
    training::Dataset dataset = armed_figure(9);

    CameraCheck() { std::filesystem::create_directories(folder.path / "plates"); }

    // Writes the images under the names of the cameras that took them, and the poses as `dataset` has them; each camera
    // has a plate of its own grey.
    training::Rig write_and_read() const {
        write_capture(folder.path, dataset);
        for (uint8_t c = 0; c < 9; ++c) {
            media::Image plate(64, 64);
            std::ranges::fill(plate.rgba, static_cast<uint8_t>(100 + c));
            for (size_t i = 3; i < plate.rgba.size(); i += 4) plate.rgba[i] = 255;
            media::write_png(folder.path / "plates" / fmt::format("c{:02}.png", c), plate);
        }
        return training::read_rig(folder.path, training::Split::kTrain);
    }
};

// By name of the shot: where its camera stands, and the camera's plate.
using Placed = std::map<std::string, std::pair<glm::dvec3, std::string>>;
Placed placed(const training::Rig& rig) {
    Placed result;
    for (const training::Shot& shot : rig.shots) {
        const training::RigCamera& camera = rig.cameras[shot.camera];
        result[shot.name] = {glm::dvec3(camera.world_from_camera[3]), camera.plate.path.filename().string()};
    }
    return result;
}

std::string all_of(const std::vector<std::string>& remarks) {
    std::string text;
    for (const std::string& remark : remarks) text += remark + "\n";
    return text;
}

TEST_F(CameraCheck, SwappedCamerasAreSwappedBack) {
    const Placed truth = placed(write_and_read());
    for (training::View& view : dataset.views)
        if (view.camera == 2 || view.camera == 7) view.camera = 9 - view.camera;
    training::Rig rig = write_and_read();
    EXPECT_NE(placed(rig), truth);
    training::check_cameras(rig);
    EXPECT_EQ(placed(rig), truth) << "each image and plate where it was taken";
    const std::string said = all_of(rig.remarks);
    EXPECT_NE(said.find("the images of cameras c02 and c07 seem to be swapped: camera c02 shows what c07 should see"),
              std::string::npos)
        << said;
    EXPECT_EQ(said.find("left out"), std::string::npos) << said;
    const size_t remarks = rig.remarks.size();
    training::check_cameras(rig);
    EXPECT_EQ(placed(rig), truth);
    EXPECT_EQ(rig.remarks.size(), remarks) << "a rig that is right stays as it is";
}

TEST_F(CameraCheck, AMisfitIsLeftOutWithAWord) {
    for (size_t i = 0; i < dataset.views.size(); ++i)
        if (dataset.views[i].camera == 4) fill(dataset, i, false);
    training::Rig rig = write_and_read();
    Placed expected = placed(rig);
    std::erase_if(expected, [](const auto& shot) { return shot.first.starts_with("c04"); });
    training::check_cameras(rig);
    EXPECT_EQ(placed(rig), expected);
    EXPECT_EQ(rig.cameras.size(), 8u);
    const std::string said = all_of(rig.remarks);
    EXPECT_NE(said.find("camera c04 is left out, as its mattes contradict the others: 0.0 % of its performer"),
              std::string::npos)
        << said;
    EXPECT_EQ(training::read_images(rig, {}).cameras.size(), 8u);
}

TEST_F(CameraCheck, ImagesWithoutMattesAreNotJudged) {
    for (size_t i = 0; i < dataset.views.size(); ++i) fill(dataset, i, true);
    training::Rig rig = write_and_read();
    const Placed before = placed(rig);
    const std::vector<std::string> remarks = rig.remarks;
    training::check_cameras(rig);
    EXPECT_EQ(placed(rig), before);
    EXPECT_EQ(rig.remarks, remarks);
}

TEST(RigAdvice, NotesFewerThanTenCameras) {
    training::Rig rig;
    rig.cameras.resize(training::kEnoughCameras);
    EXPECT_TRUE(training::advice_on(rig).empty());
    rig.cameras.pop_back();
    const std::vector<std::string> advice = training::advice_on(rig);
    ASSERT_EQ(advice.size(), 1u);
    EXPECT_EQ(advice[0].find("9 cameras are few: "), 0u) << advice[0];
    EXPECT_EQ(advice[0].find('\n'), std::string::npos);
}

TEST(RigAdvice, NotesTimesBetweenFrames) {
    const auto advice_on_times = [](const std::vector<double>& times) {
        training::Rig rig;
        rig.cameras.resize(training::kEnoughCameras);
        for (const double time : times) rig.shots.emplace_back().time = time;
        return training::advice_on(rig);
    };
    EXPECT_TRUE(advice_on_times({0, 0, 0.25, 0.5, 0.75, 1}).empty());
    EXPECT_TRUE(advice_on_times({0}).empty());
    EXPECT_TRUE(advice_on_times({0, (1 + 0.09) / 4, 0.5, 0.75, 1}).empty());
    EXPECT_EQ(advice_on_times({0, (1 + 0.11) / 4, 0.5, 0.75, 1}).size(), 1u);
    const std::vector<std::string> advice = advice_on_times({0, 6.0 / 23, 12.0 / 23, 18.0 / 23});
    ASSERT_EQ(advice.size(), 1u);
    EXPECT_EQ(advice[0].find("the images' 4 times are not even: 0.2609 is that of frame 0.78, not 1, "), 0u)
        << advice[0];
}

}  // namespace
}  // namespace neuvv::test
