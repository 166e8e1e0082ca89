// Captures of CMU's Panoptic Studio.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "media/video.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using nlohmann::json;
using training::Split;

// The rotation and the position of a camera as they are published, and a lens for small images.
json published_camera(const std::string& name, const std::string& type) {
    return {{"name", name},
            {"type", type},
            {"resolution", {64, 36}},
            {"panel", 0},
            {"node", 0},
            {"K", {{54.4, 0, 31.4}, {0, 54.3, 18.5}, {0, 0, 1}}},
            {"distCoef", {-0.217919, 0.178319, 0.000243348, 0.000605667, 0.0566046}},
            {"R",
             {{0.1335065269, 0.03328299897, -0.9904888941},
              {-0.0922107759, 0.9955175565, 0.02102302156},
              {0.9867487928, 0.08852703885, 0.1359771426}}},
            {"t", {{22.59674467}, {126.4923663}, {283.6143792}}}};
}

struct Panoptic : testing::Test {
    TemporaryFolder folder;
    json calibration = {{"calibDataSource", "160422"}, {"cameras", json::array()}};

    Panoptic() {
        for (const char* name : {"01_01", "01_02"}) calibration["cameras"].push_back(published_camera(name, "vga"));
        for (const char* name : {"00_00", "00_01", "00_02"})
            calibration["cameras"].push_back(published_camera(name, "hd"));
    }
    // Images as the toolbox's scripts extract them.
    void put_images(const std::string& parent, const std::string& camera, int count = 2) const {
        for (int i = 0; i < count; ++i)
            test::write_grey_png(folder.path / parent / camera / fmt::format("{}_{:08}.png", camera, 10 + i), 64, 36);
    }
    void put_hd_images() const {
        for (const char* name : {"00_00", "00_01", "00_02"}) put_images("hdImgs", name);
    }
    training::Rig read(Split split = Split::kTrain) const {
        write_text(folder.path / "calibration_160422_haggling1.json", calibration.dump(1, '\t'));
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const char* key, const json& value, std::initializer_list<std::string> words) {
        const json good = calibration;
        calibration["cameras"][3][key] = value;
        expect_input_error([&] { read(); }, words);
        calibration = good;
    }
};

TEST_F(Panoptic, APointFallsWhereTheToolboxPutsIt) {
    put_hd_images();
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "panoptic");
    ASSERT_EQ(rig.cameras.size(), 2u) << "00_00 is held out";
    EXPECT_EQ(rig.cameras[0].name, "00_01");
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, 1.518, 1e-3) << "metres above the floor, +Y up";
    const glm::dvec3 in_camera(0.6, -0.4, 2);  // metres
    glm::dmat3 r;
    const json camera = published_camera("", "");
    for (int i = 0; i < 9; ++i) r[i % 3][i / 3] = camera["R"][static_cast<size_t>(i / 3)][static_cast<size_t>(i % 3)];
    const glm::dvec3 t(22.59674467, 126.4923663, 283.6143792);
    const glm::dvec3 world = glm::inverse(r) * (in_camera * 100.0 - t) / 100.0;  // of Panoptic, in metres
    const double x = 0.3, y = -0.2, r2 = x * x + y * y, k1 = -0.217919, k2 = 0.178319, k3 = 0.0566046;
    const double p1 = 0.000243348, p2 = 0.000605667, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {world.x, -world.y, -world.z});
    EXPECT_NEAR(found.x, 54.4 * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + 31.4 + 0.5, 1e-6);
    EXPECT_NEAR(found.y, 54.3 * (y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)) + 18.5 + 0.5, 1e-6);
}

TEST_F(Panoptic, ImagesOfOneNumberAreOfOneTime) {
    put_hd_images();
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 4u);
    EXPECT_EQ(rig.shots[1].name, "00_01_00000011");
    EXPECT_EQ(rig.shots[1].time, 1);
    EXPECT_EQ(rig.shots[3].time, 1);
    EXPECT_EQ(rig.shots[1].image.path, folder.path / "hdImgs" / "00_01" / "00_01_00000011.png");
    EXPECT_NEAR(rig.fps, 29.97, 1e-9);
    EXPECT_TRUE(rig.remarks.empty());
    for (const char* name : {"00_00", "00_01", "00_02"}) put_images("masks", name);
    EXPECT_EQ(read().shots[3].mask.path, folder.path / "masks" / "00_02" / "00_02_00000011.png");
}

TEST_F(Panoptic, OneTypeOfCamerasIsRead) {
    for (const char* name : {"01_01", "01_02"}) put_images("vgaImgs", name);
    training::Rig rig = read();
    ASSERT_EQ(rig.cameras.size(), 1u);
    EXPECT_EQ(rig.cameras[0].name, "01_02");
    EXPECT_EQ(rig.fps, 25);
    put_hd_images();
    calibration["cameras"][0]["distCoef"] = {0, 0};  // of a camera that is not read
    rig = read();
    EXPECT_EQ(rig.cameras[0].name, "00_01");
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_NE(rig.remarks[0].find("hd was read, not vga"), std::string::npos) << rig.remarks[0];
}

TEST_F(Panoptic, VideosBearTheTypeInFrontOfTheName) {
    std::filesystem::create_directories(folder.path / "hdVideos");
    for (const char* name : {"hd_00_00", "hd_00_01"}) {
        media::VideoWriter writer(folder.path / "hdVideos" / (std::string(name) + ".mp4"), 64, 36, 30);
        for (int i = 0; i < 3; ++i) writer.add(media::Image(64, 36));
        writer.finish();
    }
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 3u);
    EXPECT_EQ(rig.shots[2].image.path, folder.path / "hdVideos" / "hd_00_01.mp4");
    EXPECT_EQ(rig.fps, 30) << "the video's own";
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_NE(rig.remarks[0].find("1 of 3 calibrated cameras"), std::string::npos);
}

TEST_F(Panoptic, DamageIsNamed) {
    put_hd_images();
    expect_bad("K", {{54, 0, 31}, {0, 54, 18}}, {"calibration_160422", "cameras[3].K", "9 numbers"});
    expect_bad("K", {{54, 5, 31}, {0, 54, 18}, {0, 0, 1}}, {"cameras[3].K", "skew"});
    expect_bad("K", {{54, 0, "x"}, {0, 54, 18}, {0, 0, 1}}, {"cameras[3].K[0][2]", "number"});
    expect_bad("distCoef", {1, 2}, {"cameras[3].distCoef", "5 numbers"});
    expect_bad("R", {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {"cameras[3].R", "no rotation"});
    expect_bad("t", {1, 2}, {"cameras[3].t", "3 numbers"});
    expect_bad("t", {1e12, 2, 3}, {"cameras[3]", "origin"});
    expect_bad("name", "../00_01", {"cameras[3]", "folder"});
    expect_bad("name", "00_00", {"cameras[3]", "another camera of the name 00_00"});
    expect_bad("resolution", {64}, {"cameras[3].resolution"});
    expect_bad("resolution", {64, 40}, {"64×36", "64×40", "another shape"});
    expect_bad("type", 3, {"cameras[3].type", "string"});
    calibration["cameras"] = json::array();
    write_text(folder.path / "calibration_160422_haggling1.json", calibration.dump());
    expect_input_error([&] { training::read_rig(folder.path, Split::kTrain, "panoptic"); }, {"no calibration"});
}

}  // namespace
}  // namespace neuvv
