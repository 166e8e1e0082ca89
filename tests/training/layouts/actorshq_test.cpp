// ActorsHQ's captures.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using training::Split;

struct ActorsHq : testing::Test {
    TemporaryFolder folder;
    std::string header = "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py";
    // The first camera is that of ActorsHQ's own page, nearer to the actor; two more are turned.
    std::vector<std::string> rows = {"Cam001,64,48,3.14159265359,0.0,0.0,1.0,0.0,2.3,1.773863,1.773863,0.5,0.5",
                                     "Cam002,64,48,0.3,-0.2,0.5,1,1.5,-2,1.5,2,0.49,0.52",
                                     "Cam010,48,64,0,0,0,0,0,-3,1.5,1.5,0.5,0.5"};

    ActorsHq() {
        for (const char* camera : {"Cam001", "Cam002", "Cam010"})
            for (int frame = 0; frame < 2; ++frame) {
                const bool tall = std::string(camera) == "Cam010";
                const auto put = [&](const char* parent, const char* word, const char* ending) {
                    test::write_grey_png(
                        folder.path / parent / camera / fmt::format("{}_{}{:06}.{}", camera, word, frame, ending),
                        tall ? 48 : 64, tall ? 64 : 48);
                };
                put("rgbs", "rgb", "jpg");
                put("masks", "mask", "png");
            }
    }
    training::Rig read(Split split = Split::kTrain) const {
        std::string text = header + "\r\n";
        for (const std::string& row : rows) text += row + "\r\n";
        write_text(folder.path / "calibration.csv", text);
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const std::string& row, std::initializer_list<std::string> words) {
        const std::string good = rows[1];
        rows[1] = row;
        expect_input_error([&] { read(); }, words);
        rows[1] = good;
    }
};

TEST_F(ActorsHq, APointFallsWhereItsLoaderPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "actorshq");
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[0].name, "Cam002");
    const glm::dvec3 in_camera(0.6, -0.4, 2), axis(0.3, -0.2, 0.5);
    const glm::dvec3 world =
        glm::angleAxis(glm::length(axis), glm::normalize(axis)) * in_camera + glm::dvec3(1, 1.5, -2);
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], world);
    EXPECT_NEAR(found.x, 64 * (1.5 * 0.3 + 0.49), 1e-9);
    EXPECT_NEAR(found.y, 48 * (2 * -0.2 + 0.52), 1e-9);
    const glm::dmat4 pose = read(Split::kTest).cameras.at(0).world_from_camera;
    EXPECT_NEAR(pose[1].y, 1, 1e-9) << "half a turn about x: the image's up is the world's +Y";
    EXPECT_NEAR(pose[2].z, 1, 1e-9) << "and it looks along −Z";
    EXPECT_NEAR(pose[3].z, 2.3, 1e-12);
}

TEST_F(ActorsHq, ImagesAndMasksMeetByNumber) {
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 4u);
    EXPECT_EQ(rig.shots[1].name, "Cam002_000001");
    EXPECT_EQ(rig.shots[1].time, 1);
    EXPECT_EQ(rig.shots[1].image.path, folder.path / "rgbs" / "Cam002" / "Cam002_rgb000001.jpg");
    EXPECT_EQ(rig.shots[1].mask.path, folder.path / "masks" / "Cam002" / "Cam002_mask000001.png");
    EXPECT_EQ(rig.cameras[1].lens.height, 64u);
    std::filesystem::remove(folder.path / "masks" / "Cam002" / "Cam002_mask000001.png");
    expect_input_error([&] { read(); }, {"masks/Cam002", "no mask 000001"});
}

TEST_F(ActorsHq, TheTableMayHaveSpacesAndOtherColumns) {
    header = "name, w, h, rx, ry, rz, tx, ty, tz, fx, fy, px, py, k1";
    for (std::string& row : rows) row += ", 0";
    EXPECT_EQ(read().cameras.size(), 2u);
}

TEST_F(ActorsHq, DamageIsNamed) {
    expect_bad("Cam002,64,48,0,0,0,1,1,1,1.5,1.5,0.5,half", {"calibration.csv", "line 3, py", "half"});
    expect_bad("Cam002,64,48,0,0,0,1,1,1,1.5", {"line 3", "ends before its fy"});
    expect_bad("Cam002,64.5,48,0,0,0,1,1,1,1.5,1.5,0.5,0.5", {"line 3, w", "64.5"});
    expect_bad("Cam002,64,-1,0,0,0,1,1,1,1.5,1.5,0.5,0.5", {"line 3, h", "-1"});
    expect_bad("Cam002,64,48,1e9,0,0,1,1,1,1.5,1.5,0.5,0.5", {"line 3", "no rotation"});
    expect_bad("Cam002,64,48,0,0,0,1e12,1,1,1.5,1.5,0.5,0.5", {"line 3", "origin"});
    expect_bad("Cam002,64,48,0,0,0,1,1,1,-1.5,1.5,0.5,0.5", {"line 3", "focal"});
    expect_bad("../Cam002,64,48,0,0,0,1,1,1,1.5,1.5,0.5,0.5", {"line 3", "../Cam002", "folder"});
    expect_bad("Cam001,64,48,0,0,0,1,1,1,1.5,1.5,0.5,0.5", {"line 3", "another camera of the name Cam001"});
    expect_bad("Cam002,64,64,0,0,0,1,1,1,1.5,1.5,0.5,0.5", {"64×48", "64×64", "another shape"});
    header = "name,w,h,rx,ry,rz,tx,ty,fx,fy,px,py";
    expect_input_error([&] { read(); }, {"calibration.csv", "header", "tz"});
    rows.clear();
    header = "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py";
    expect_input_error([&] { read(); }, {"calibration.csv", "no camera"});
}

}  // namespace
}  // namespace neuvv
