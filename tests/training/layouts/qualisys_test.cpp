// Cameras that Qualisys Track Manager exported.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "media/video.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

struct Qualisys : testing::Test {
    TemporaryFolder folder;
    std::string version = "2022.1", unit = "1000", sensor = "4095";
    std::string video =
        "<fov_video left=\"0\" top=\"0\" right=\"63\" bottom=\"47\"/>"
        "<fov_video_max left=\"0\" top=\"0\" right=\"63\" bottom=\"47\"/>";
    std::string marker_transform;  // where it is not empty, that of the camera without a video
    std::string rotation = "r11=\"0\" r12=\"1\" r13=\"0\" r21=\"0\" r22=\"0\" r23=\"1\" r31=\"1\" r32=\"0\" r33=\"0\"";
    std::string lens =
        "focalLengthU=\"5760\" focalLengthV=\"6080\" centerPointU=\"2000\" centerPointV=\"1500\" "
        "skew=\"0\" radialDistortion1=\"0.1\" radialDistortion2=\"-0.05\" radialDistortion3=\"0.03\" "
        "tangentalDistortion1=\"0.01\" tangentalDistortion2=\"0.02\"";

    Qualisys() {
        std::filesystem::create_directories(folder.path / "videos");
        for (const char* serial : {"26578", "26579", "26580"}) {
            media::VideoWriter writer(folder.path / "videos" / (std::string("walk_Miqus_1_") + serial + ".mp4"), 64, 48,
                                      25);
            for (int i = 0; i < 3; ++i) writer.add(media::Image(64, 48));
            writer.finish();
        }
    }
    // The second video camera stands at (1, 2, 3) m and looks along −X, its up is +Z; the last camera sees markers
    // only.
    std::string xml() const {
        std::string text =
            "<calibration created=\"2022-03-01\" qtm-version=\"" + version + "\" type=\"regular\">\n<cameras>\n";
        const double metre = std::stod(unit);
        for (int i = 0; i < 4; ++i) {
            const std::string transform = i == 3 && !marker_transform.empty()
                                              ? marker_transform
                                              : fmt::format("<transform x=\"{}\" y=\"{}\" z=\"{}\" {}/>", i * metre,
                                                            2 * metre, 3 * metre, rotation);
            text += fmt::format(
                "<camera active=\"1\" serial=\"{}\" model=\"{}\" viewrotation=\"{}\">{}{}<intrinsic "
                "focallength=\"9.2\" sensorMinU=\"0\" sensorMaxU=\"{}\" {}/></camera>\n",
                26578 + i, i < 3 ? "Miqus Video" : "Miqus M3", i == 1 ? 90 : 0, video, transform, sensor, lens);
        }
        return text + "</cameras>\n</calibration>\n";
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "calibration" / "Calib.qca.txt", xml());
        return training::read_rig(folder.path, split);
    }
    void expect_bad(std::string Qualisys::*part, const std::string& from, const std::string& to,
                    std::initializer_list<std::string> words) {
        const std::string good = this->*part;
        const size_t at = good.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        (this->*part).replace(at, from.size(), to);
        expect_input_error([&] { read(); }, words);
        this->*part = good;
    }
    // Expects that a point is where Pose2Sim's formulas put it, with distortions as large as OpenCV has them.
    void expect_pixel(const training::Rig& rig, double scale = 1, glm::dvec2 corner = {0, 0}) const {
        const glm::dvec3 from_camera = glm::dvec3(-1.5, 2.4, 3.3) - glm::dvec3(1, 2, 3);
        // The rows of the rotation are (0,1,0), (0,0,1), (1,0,0): the camera's x is +Y, its y +Z, and it looks along
        // −X.
        const double x = from_camera.y / -from_camera.x, y = -from_camera.z / -from_camera.x, r2 = x * x + y * y;
        const double radial = 1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2;
        const double u = 90 * (x * radial + 2 * 0.01 * x * y + 0.02 * (r2 + 2 * x * x)) + 2000 / 64.0;
        const double v = 95 * (y * radial + 2 * 0.02 * x * y + 0.01 * (r2 + 2 * y * y)) + 1500 / 64.0;
        ASSERT_EQ(rig.cameras.at(0).name, "26579");
        const glm::dvec2 found = test::pixel_of(rig.cameras[0], {-1.5, 3.3, -2.4});
        EXPECT_NEAR(found.x, scale * u - corner.x, 1e-9);
        EXPECT_NEAR(found.y, scale * v - corner.y, 1e-9);
    }
};

TEST_F(Qualisys, APointFallsWherePose2SimPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "qualisys");
    EXPECT_EQ(rig.cameras.size(), 2u);
    expect_pixel(rig);
    EXPECT_EQ(rig.fps, 25);
    EXPECT_EQ(rig.shots.size(), 6u);
    EXPECT_NE(rig.world.find("from millimetres"), std::string::npos) << rig.world;
    ASSERT_EQ(rig.remarks.size(), 2u);
    EXPECT_NE(rig.remarks[0].find("26579 has a viewrotation"), std::string::npos) << rig.remarks[0];
    EXPECT_NE(rig.remarks[1].find("1 of 4"), std::string::npos) << "the marker camera has no video";
}

// Neither its pose nor how far away it stands counts for the cameras that have videos.
TEST_F(Qualisys, CamerasWithoutVideosAreNotChecked) {
    unit = "1";
    marker_transform = "<transform x=\"9000\" y=\"0\" z=\"0\" r11=\"7\"/>";
    const training::Rig rig = read();
    expect_pixel(rig);
    EXPECT_NE(rig.world.find("from metres"), std::string::npos) << rig.world;
    EXPECT_EQ(rig.cameras.size(), 2u);
    std::filesystem::create_directories(folder.path / "images");
    media::write_png(folder.path / "images" / "26581.png", media::Image(64, 48));
    expect_input_error([&] { read(); }, {"transform, line 6", "r12"});
}

// As in Pose2Sim's demo, where the calibration has cam_01 and the video is cam01.
TEST_F(Qualisys, VideosOfOtherNamesBelongToCamerasByOrder) {
    for (const char* serial : {"26578", "26579", "26580"})
        std::filesystem::rename(folder.path / "videos" / fmt::format("walk_Miqus_1_{}.mp4", serial),
                                folder.path / "videos" / fmt::format("cam{}.mp4", serial[4]));
    expect_input_error([&] { read(); }, {"Calib.qca.txt", "4 cameras", "the images of 3"});
    std::filesystem::copy(folder.path / "videos" / "cam8.mp4", folder.path / "videos" / "cam10.mp4");
    const training::Rig rig = read();
    ASSERT_EQ(rig.cameras.size(), 3u);
    EXPECT_EQ(rig.cameras[0].name, "cam8") << "cam0 is held out";
    EXPECT_EQ(rig.cameras[0].world_from_camera[3].x, 1) << "the second by its serial number";
    EXPECT_EQ(rig.cameras[2].name, "cam10");
    EXPECT_NE(std::ranges::find(rig.remarks, "camera 26579: videos/cam8.*, by their order"), rig.remarks.end());
}

TEST_F(Qualisys, MetresAreTakenAsMetres) {
    unit = "1";
    const training::Rig rig = read();
    expect_pixel(rig);
    EXPECT_NE(rig.world.find("from metres"), std::string::npos) << rig.world;
}

TEST_F(Qualisys, BinnedAndCroppedVideosCount) {
    video =
        "<fov_video left=\"2\" top=\"3\" right=\"65\" bottom=\"50\"/>"
        "<fov_video_max left=\"0\" top=\"0\" right=\"79\" bottom=\"59\"/>";
    sensor = "10239";  // 160 pixels, two to a pixel of the video
    expect_pixel(read(), 0.5, {2, 3});
}

// Pose2Sim writes files of this kind, too, with distortions that are 64 times as large.
TEST_F(Qualisys, TheDistortionsOfPose2SimsFilesAreDivided) {
    version = "none";
    lens =
        "focalLengthU=\"5760\" focalLengthV=\"6080\" centerPointU=\"2000\" centerPointV=\"1500\" "
        "radialDistortion1=\"6.4\" radialDistortion2=\"-3.2\" radialDistortion3=\"1.92\" "
        "tangentalDistortion1=\"0.64\" tangentalDistortion2=\"1.28\"";
    expect_pixel(read());
}

TEST_F(Qualisys, DamageIsNamed) {
    constexpr auto in = &Qualisys::lens;
    expect_bad(in, "focalLengthU", "focalLengthX", {"Calib.qca.txt", "intrinsic, line 3", "focalLengthU"});
    expect_bad(in, "5760", "-5760", {"camera, line 3", "focal"});
    expect_bad(in, "5760", "5760px", {"focalLengthU", "5760px"});
    expect_bad(in, "skew=\"0\"", "skew=\"900\"", {"skew"});
    expect_bad(&Qualisys::sensor, "4095", "63", {"intrinsic, line 3", "Qualisys"});
    expect_bad(&Qualisys::sensor, "4095", "6000", {"intrinsic, line 3", "units"});
    expect_bad(&Qualisys::video, "right=\"63\"", "right=\"-2\"", {"fov_video"});
    expect_bad(&Qualisys::video, "right=\"63\"", "right=\"39\"", {"64×48", "40×48"});
    expect_bad(&Qualisys::rotation, "r12=\"1\"", "r12=\"0.5\"", {"transform, line 3", "no rotation"});
    expect_bad(&Qualisys::rotation, "r12=\"1\"", "", {"transform, line 3", "r12"});
    std::filesystem::copy(folder.path / "videos" / "walk_Miqus_1_26579.mp4", folder.path / "videos" / "run_26579.mp4");
    expect_input_error([&] { read(); }, {"26579", "one video a camera"});
}

}  // namespace
}  // namespace neuvv
