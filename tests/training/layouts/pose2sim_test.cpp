// Cameras that Pose2Sim or anipose calibrated.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "media/video.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

struct Pose2Sim : testing::Test {
    TemporaryFolder folder;
    std::string first =
        "[cam_2]\nname = \"cam_2\"\nsize = [ 64.0, 48.0]\n"
        "matrix = [ [ 90.0, 0.0, 31.0], [ 0.0, 95.0, 22.0], [ 0.0, 0.0, 1.0]]\n"
        "distortions = [ 0.1, -0.05, 0.01, 0.02]\nrotation = [ 0.3, -0.2, 0.5]\n"
        "translation = [ 0.25, -0.5, 4.0]\nfisheye = false\n\n";
    std::string others =
        "[cam_10]\nname = \"cam_10\"\nsize = [ 64.0, 48.0]\n"
        "matrix = [ [ 90.0, 0.0, 31.0], [ 0.0, 95.0, 22.0], [ 0.0, 0.0, 1.0]]\n"
        "distortions = [ 0.1, -0.05, 0.02, 0.01]\nrotation = [ 0, 0, 0]\n"
        "translation = [ 0, 0, 4]\nfisheye = true\n\n"
        "[cam_1]\nname = \"cam_1\"\nsize = [ 64.0, 48.0]\n"
        "matrix = [ [ 90.0, 0.0, 31.0], [ 0.0, 95.0, 22.0], [ 0.0, 0.0, 1.0]]\n"
        "distortions = [ 0.0, 0.0, 0.0, 0.0]\nrotation = [ 0, 0, 0]\ntranslation = [ 0, 0, 5]\n"
        "fisheye = false\n\n[metadata]\nadjusted = false\nerror = 0.0\n";

    void write_videos(std::initializer_list<const char*> names, const std::string& trial = "",
                      uint32_t width = 64) const {
        const std::filesystem::path videos = folder.path / trial / "videos";
        std::filesystem::create_directories(videos);
        for (const char* name : names) {
            media::VideoWriter writer(videos / (std::string(name) + ".mp4"), width, 48, 30);
            for (int i = 0; i < 2; ++i) writer.add(media::Image(width, 48));
            writer.finish();
        }
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "calibration" / "Calib_scene.toml", first + others);
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const std::string& from, const std::string& to, std::initializer_list<std::string> words) {
        const std::string good = first;
        const size_t at = good.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        first.replace(at, from.size(), to);
        expect_input_error([&] { read(); }, words);
        first = good;
    }
};

TEST_F(Pose2Sim, APointFallsWhereOpenCvPutsIt) {
    write_videos({"cam_1", "cam_2", "cam_10"});
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "pose2sim");
    ASSERT_EQ(rig.cameras.size(), 2u) << "cam_1 is held out";
    EXPECT_EQ(rig.cameras[0].name, "cam_2");
    EXPECT_TRUE(rig.remarks.empty());
    const glm::dvec3 in_camera(0.9, -0.6, 3), axis(0.3, -0.2, 0.5), t(0.25, -0.5, 4);
    const glm::dvec3 world = glm::angleAxis(-glm::length(axis), glm::normalize(axis)) * (in_camera - t);
    const double x = 0.3, y = -0.2, r2 = x * x + y * y, radial = 1 + 0.1 * r2 - 0.05 * r2 * r2;
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {world.x, world.z, -world.y});
    EXPECT_NEAR(found.x, 90 * (x * radial + 2 * 0.01 * x * y + 0.02 * (r2 + 2 * x * x)) + 31 + 0.5, 1e-9);
    EXPECT_NEAR(found.y, 95 * (y * radial + 2 * 0.02 * x * y + 0.01 * (r2 + 2 * y * y)) + 22 + 0.5, 1e-9);
}

TEST_F(Pose2Sim, FisheyesHaveFourRadialTerms) {
    write_videos({"cam_1", "cam_2", "cam_10"});
    const double r = 1.2, angle = std::atan(r), a2 = angle * angle;
    const double bent = angle * (1 + a2 * (0.1 + a2 * (-0.05 + a2 * (0.02 + a2 * 0.01))));
    const glm::dvec2 found = test::pixel_of(read().cameras.at(1), {3 * r, 3 - 4, 0});
    EXPECT_NEAR(found.x, 90 * bent + 31.5, 1e-9);
    EXPECT_NEAR(found.y, 22.5, 1e-9);
}

// As in Pose2Sim's own demo, where cameras are named after the images of their calibration.
TEST_F(Pose2Sim, VideosOfOtherNamesBelongToCamerasByOrder) {
    write_videos({"left", "middle", "right"});
    const training::Rig rig = read();
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[0].name, "middle");
    EXPECT_EQ(rig.cameras[0].lens.model, interchange::LensModel::kBrown);
    EXPECT_EQ(rig.cameras[1].lens.model, interchange::LensModel::kFisheye) << "cam_10 is the last in natural order";
    ASSERT_EQ(rig.remarks.size(), 3u);
    EXPECT_EQ(rig.remarks[1], "camera cam_2: videos/middle.*, by their order");
    write_videos({"another"});
    expect_input_error([&] { read(); }, {"Calib_scene.toml", "3 cameras", "videos/ has the images of 4"});
}

// Pose2Sim has trials in the folder of their session, or of a participant there.
TEST_F(Pose2Sim, TrialsHaveTheCalibrationOfTheirSession) {
    for (const char* trial : {"walk", "anna/walk"}) {
        write_videos({"cam_1", "cam_2", "cam_10"}, trial);
        expect_input_error([&] { training::read_rig(folder.path / trial, training::Split::kTrain); },
                           {"no data set of a known layout"});
    }
    write_text(folder.path / "calibration" / "Calib_scene.toml", first + others);
    for (const char* trial : {"walk", "walk/", "anna/walk"}) {
        const training::Rig rig = training::read_rig(folder.path / trial, training::Split::kTrain);
        EXPECT_EQ(rig.format, "pose2sim");
        EXPECT_EQ(rig.cameras.size(), 2u) << trial;
        EXPECT_NE(rig.file.find("calibration/Calib_scene.toml"), std::string::npos);
    }
    // The nearest one counts, a trial's own before all; other folders are no trials.
    write_text(folder.path / "anna" / "Calib.toml", others);
    EXPECT_NE(training::read_rig(folder.path / "anna/walk", training::Split::kTrain).file.find("anna/Calib.toml"),
              std::string::npos);
    write_text(folder.path / "walk" / "Calib.toml", first + others);
    EXPECT_NE(training::read_rig(folder.path / "walk", training::Split::kTrain).file.find("walk/Calib.toml"),
              std::string::npos);
    std::filesystem::create_directories(folder.path / "notes");
    expect_input_error([&] { training::read_rig(folder.path / "notes", training::Split::kTrain); },
                       {"no data set of a known layout"});
}

// Points need no images: those of the calibration's shape are taken as they are.
TEST_F(Pose2Sim, ImagesOfAnotherShapeMatterOnlyWhereTheyAreRead) {
    write_videos({"cam_1", "cam_2", "cam_10"}, "", 60);
    expect_input_error([&] { read(); }, {"60×48", "64×48", "another shape"});
    const training::Rig rig = training::read_rig_of_points(folder.path);
    ASSERT_EQ(rig.cameras.size(), 3u) << "of all splits";
    EXPECT_EQ(rig.shots.size(), 6u);
    EXPECT_EQ(rig.cameras[1].lens.width, 64u);
    EXPECT_EQ(rig.cameras[1].lens.cx, 31.5);
    EXPECT_TRUE(rig.misfit);
}

TEST_F(Pose2Sim, DamageIsNamed) {
    write_videos({"cam_1", "cam_2", "cam_10"});
    expect_bad("90.0, 0.0", "90.0, 5.0", {"Calib_scene.toml", "[cam_2]", "skew"});
    expect_bad("90.0, 0.0, 31.0", "90.0, 0.0", {"[cam_2] matrix, line 4", "8 numbers"});
    expect_bad("90.0", "\"wide\"", {"[cam_2] matrix, line 4", "no number"});
    expect_bad("90.0", "inf", {"[cam_2] matrix", "no number"});
    expect_bad("90.0", "-90.0", {"[cam_2]", "focal"});
    expect_bad("rotation", "rotations", {"[cam_2] rotation, line", "no array"});
    expect_bad("64.0", "0.0", {"[cam_2] size", "side of 0"});
    expect_bad(" 4.0]", " 4.0e9]", {"[cam_2]", "origin"});
    expect_bad("\"cam_2\"", "\"../cam_2\"", {"../cam_2", "folder"});
    expect_bad("\"cam_2\"", "\"cam_1\"", {"cam_1", "name"});
    expect_bad("[ 64.0", "[ 64.0.0", {"Calib_scene.toml", "line 3", "no TOML"});
    expect_bad("64.0, 48.0", "64.0, 40.0", {"64×48", "64×40", "another shape"});
}

}  // namespace
}  // namespace neuvv
