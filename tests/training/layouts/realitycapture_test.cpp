// The table of cameras that RealityCapture exports.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

struct RealityCapture : testing::Test {
    TemporaryFolder folder;
    std::string begin = "#cameras 3\r\n", header = "#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2";
    // The angles of the second camera are those of a file that RealityCapture exported.
    std::vector<std::string> rows = {
        "a.tif,0,0,0,0,90,0,18,0,0,0,0,0,0,0,0",
        "b.tif,1,2,3,163.736597399311,83.4154313461628,174.386496244756,18,0.05,-0.025,0.1,-0.05,0.03,0,0,0",
        "c.tif,5,0,0,0,90,0,18,0,0,0,0,0,0,0,0"};

    RealityCapture() {
        for (const char* camera : {"a", "b", "c"})
            test::write_grey_png(folder.path / "images" / (std::string(camera) + ".png"), 48, 64);
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        std::string text = begin + header + "\r\n";
        for (const std::string& row : rows) text += row + "\r\n";
        write_text(folder.path / "registration.csv", text);
        return training::read_rig(folder.path, split);
    }
    void expect_bad(size_t row, const std::string& value, std::initializer_list<std::string> words) {
        const std::string good = rows[row];
        rows[row] = value;
        expect_input_error([&] { read(); }, words);
        rows[row] = good;
    }
};

// The rotation that RealityCapture's XMP file has of the same camera: from the world to the camera, OpenCV's axes.
TEST_F(RealityCapture, APointFallsWhereTheXmpFilePutsIt) {
    const glm::dmat3 xmp = glm::transpose(glm::dmat3(0.982594073038806, 0.185426733553445, -0.0112166890261935,
                                                     -0.032113633044729, 0.11008102707942, -0.993403685341366,
                                                     -0.18296885582437, 0.976472781986697, 0.114119689));
    const double x = 0.3, y = -0.2, r2 = x * x + y * y;
    const glm::dvec3 world = glm::transpose(xmp) * glm::dvec3(3 * x, 3 * y, 3) + glm::dvec3(1, 2, 3);
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "realitycapture");
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[0].name, "b");
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {world.x, world.z, -world.y});
    const double radial = 1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2;
    EXPECT_NEAR(found.x, 24 + 0.05 * 64 + 32 * radial * x, 1e-6) << "f is half of the longer side";
    EXPECT_NEAR(found.y, 32 - 0.025 * 64 + 32 * radial * y, 1e-6);
}

TEST_F(RealityCapture, APitchOf90DegreesIsLevelAndLooksNorth) {
    const training::Rig rig = read(training::Split::kTest);
    ASSERT_EQ(rig.cameras.size(), 1u);
    const glm::dmat4& pose = rig.cameras[0].world_from_camera;
    EXPECT_NEAR(pose[1].y, 1, 1e-12) << "its up is the world's";
    EXPECT_NEAR(-pose[2].z, -1, 1e-12) << "+Y of the file is −Z of NeuVV's world";
    EXPECT_EQ(rig.shots.size(), 1u) << "a still of one frame";
}

TEST_F(RealityCapture, ColumnsMayBeFewerAndInAnotherOrder) {
    begin = "\xef\xbb\xbf";
    header = "#name,f,heading,pitch,roll,alt,y,x,extra";
    rows = {"a.jpg,36,0,90,0,3,2,1,7", "b.jpg,36,0,90,0,3,2,1,7"};
    const training::Rig rig = read();
    EXPECT_EQ(rig.cameras.at(0).lens.fx, 64);
    EXPECT_EQ(glm::dvec3(rig.cameras[0].world_from_camera[3]), glm::dvec3(1, 3, -2));
}

TEST_F(RealityCapture, DamageIsNamed) {
    expect_bad(1, "b.tif,1,2,3,0,90,0,18,0,0,0,0,0,0.1,0,0",
               {"registration.csv", "line 4", "camera b", "k4", "Brown3"});
    expect_bad(1, "b.tif,1,2,3,0,90,0,18,0,0,0,0,0,0,0.1,0", {"line 4", "t1"});
    expect_bad(1, "b.tif,1,2,3,0,90,0,18,0,0,0,0,0,0,0,0.1", {"line 4", "t2"});
    expect_bad(1, "b.tif,1,2,3,0,ninety,0,18,0,0,0,0,0,0,0,0", {"line 4, pitch", "ninety"});
    expect_bad(1, "b.tif,1,2,3,0,inf,0,18,0,0,0,0,0,0,0,0", {"line 4, pitch"});
    expect_bad(1, "b.tif,1,2,3", {"line 4", "ends before its heading"});
    expect_bad(1, "b.tif,1,2,3,0,90,0,-18,0,0,0,0,0,0,0,0", {"line 4", "focal"});
    expect_bad(1, "../b.tif,1,2,3,0,90,0,18,0,0,0,0,0,0,0,0", {"line 4", "../b"});
    expect_bad(1, "a.png,1,2,3,0,90,0,18,0,0,0,0,0,0,0,0", {"line 4", "name a"});
    expect_bad(1, "b.tif,4e9,2,3,0,90,0,18,0,0,0,0,0,0,0,0", {"line 4", "origin"});
    header = "#name,x,y,heading,pitch,roll,f";
    expect_input_error([&] { read(); }, {"registration.csv", "header", "alt"});
    header = "#names,x,y,alt,heading,pitch,roll,f";
    expect_input_error([&] { read(); }, {"registration.csv", "header", "no column name"});
}

}  // namespace
}  // namespace neuvv
