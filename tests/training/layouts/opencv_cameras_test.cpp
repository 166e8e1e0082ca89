// Calibrations that programs wrote with OpenCV's FileStorage, a file for each camera.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using test::yaml_matrix;

constexpr const char* kHead = "%YAML:1.0\r\n---\r\ncalibration_time: \"Mon Nov 2 10:00:00 2026\"\r\n";

struct OpencvCameras : testing::Test {
    TemporaryFolder folder;
    const std::vector<double> matrix = {90, 0, 31, 0, 95, 22, 0, 0, 1};
    // As OpenCV's samples name them, and as other programs do; the third is ROS' and a fisheye.
    std::string a = kHead + yaml_matrix("camera_matrix", 3, 3, matrix) + "image_width: 64\r\nimage_height: 48\r\n" +
                    yaml_matrix("R", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) + yaml_matrix("T", 3, 1, {0, 0, 3});
    std::string b = kHead + yaml_matrix("cameraMatrix", 3, 3, matrix) +
                    yaml_matrix("distCoeffs", 1, 8, {0.1, -0.05, 0.01, 0.02, 0.03, 0.2, 0.1, 0.05}) +
                    yaml_matrix("rvec", 3, 1, {0.3, -0.2, 0.5}) + yaml_matrix("tvec", 3, 1, {0.25, -0.5, 4});
    std::string c =
        "camera_name: c\nimage_width: 64\nimage_height: 48\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
        "  data: [90, 0, 31, 0, 95, 22, 0, 0, 1]\ndistortion_model: equidistant\n"
        "distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: [0.1, -0.05, 0.02, 0.01]\n"
        "R: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
        "T: {rows: 3, cols: 1, data: [0, 0, 3]}\n";

    OpencvCameras() {
        for (const char* camera : {"a", "b", "c"})
            for (const char* frame : {"000000.png", "000001.png"})
                test::write_grey_png(folder.path / camera / frame, 64, 48);
        write_text(folder.path / "settings.yml", "%YAML:1.0\n---\nboard_width: 9\n");
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "a.yml", a);
        write_text(folder.path / "b.yml", b);
        write_text(folder.path / "c.yaml", c);
        return training::read_rig(folder.path, split);
    }
    void expect_bad(std::string OpencvCameras::*file, const std::string& from, const std::string& to,
                    std::initializer_list<std::string> words) {
        const std::string good = this->*file;
        const size_t at = good.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        (this->*file).replace(at, from.size(), to);
        expect_input_error([&] { read(); }, words);
        this->*file = good;
    }
};

TEST_F(OpencvCameras, APointFallsWhereOpenCvPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "opencv");
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[0].name, "b");
    EXPECT_EQ(rig.shots.size(), 4u);
    const glm::dvec3 in_camera(0.9, -0.6, 3), axis(0.3, -0.2, 0.5), t(0.25, -0.5, 4);
    const glm::dvec3 world = glm::angleAxis(-glm::length(axis), glm::normalize(axis)) * (in_camera - t);
    const double x = 0.3, y = -0.2, r2 = x * x + y * y;
    const double radial =
        (1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2) / (1 + 0.2 * r2 + 0.1 * r2 * r2 + 0.05 * r2 * r2 * r2);
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], world);
    EXPECT_NEAR(found.x, 90 * (x * radial + 2 * 0.01 * x * y + 0.02 * (r2 + 2 * x * x)) + 31 + 0.5, 1e-7);
    EXPECT_NEAR(found.y, 95 * (y * radial + 2 * 0.02 * x * y + 0.01 * (r2 + 2 * y * y)) + 22 + 0.5, 1e-7);
}

TEST_F(OpencvCameras, EquidistantLensesAreFisheyes) {
    const double r = 1.2, angle = std::atan(r), a2 = angle * angle;
    const double bent = angle * (1 + a2 * (0.1 + a2 * (-0.05 + a2 * (0.02 + a2 * 0.01))));
    EXPECT_NEAR(test::pixel_of(read().cameras.at(1), {3 * r, 0, 0}).x, 90 * bent + 31.5, 1e-9);
}

TEST_F(OpencvCameras, DamageIsNamed) {
    constexpr auto in_b = &OpencvCameras::b, in_c = &OpencvCameras::c;
    expect_bad(in_b, "rvec", "wvec", {"b.yml", "R", "missing", "world to camera"});
    expect_bad(in_b, "tvec", "wvec", {"b.yml", "T", "missing"});
    expect_bad(in_b, "90.0", "-90.0", {"b.yml", "cameraMatrix", "focal"});
    expect_bad(in_c, "equidistant", "thin_prism", {"c.yaml", "distortion_model", "thin_prism"});
    expect_bad(in_c, "image_width: 64", "image_width: 0.5", {"c.yaml", "image_width"});
    expect_bad(in_c, "image_width: 64", "image_width: 60", {"c.yaml", "64×48", "60×48"});
    expect_bad(in_c, "cols: 4\n  data: [", "cols: 5\n  data: [9, ", {"c.yaml", "4 terms"});
    expect_bad(&OpencvCameras::a, "[1.0000000000, 0.0", "[-1.0000000000, 0.0", {"a.yml", "R", "no rotation"});
}

}  // namespace
}  // namespace neuvv
