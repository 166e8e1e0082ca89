// What image files and videos say about how they are shown, and when, as data sets take it.
#include "training/data/layouts/rig/presentation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/jpeg_file.h"
#include "support/video_file.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv {
namespace {

using test::VideoFile;
using test::yaml_matrix;

struct PresentationTest : testing::Test {
    TemporaryFolder folder;

    // Three cameras for images of this size.
    void calibrate(uint32_t width, uint32_t height) const {
        const std::vector<std::string> names = {"01", "02", "03"};
        std::string intrinsics = test::yaml_names(names), extrinsics = intrinsics;
        for (size_t i = 0; i < names.size(); ++i) {
            intrinsics += yaml_matrix("K_" + names[i], 3, 3, {90, 0, 31, 0, 90, 22, 0, 0, 1});
            intrinsics += fmt::format("H_{0}: {2}\r\nW_{0}: {1}\r\n", names[i], width, height);
            extrinsics += yaml_matrix("R_" + names[i], 3, 1, {0.1 * static_cast<double>(i), 0, 0});
            extrinsics += yaml_matrix("T_" + names[i], 3, 1, {0, 0, 4});
        }
        write_text(folder.path / "intri.yml", intrinsics);
        write_text(folder.path / "extri.yml", extrinsics);
    }
    void write_videos(const VideoFile& first, const VideoFile& second, const VideoFile& third) const {
        std::filesystem::create_directories(folder.path / "videos");
        write_video_file(folder.path / "videos/01.mp4", first);
        write_video_file(folder.path / "videos/02.mp4", second);
        write_video_file(folder.path / "videos/03.mp4", third);
    }
    void write_images(const std::string& bytes) const {
        for (const char* camera : {"01", "02", "03"}) {
            std::filesystem::create_directories(folder.path / "images" / camera);
            write_text(folder.path / "images" / camera / "000000.jpg", bytes);
        }
    }
    training::Rig read() const { return training::read_rig(folder.path, training::Split::kTrain); }
};

std::string remarks(const training::Rig& rig) {
    return fmt::format("{}\n", fmt::join(rig.remarks, "\n"));
}

TEST_F(PresentationTest, ExifTurnsImagesOfCalibrationsByOpenCv) {
    calibrate(8, 16);
    write_images(test::jpeg(test::exif(6, true), 16, 8));
    const training::Rig rig = read();
    EXPECT_EQ(training::size_of(rig.shots[0].image), (media::ImageSize{8, 16}));
    EXPECT_EQ(training::ImageReader().read(rig.shots[0].image).width, 8u);
    EXPECT_EQ(remarks(rig), "cameras 02, 03: images shown turned by 90° clockwise, as their Exif says\n");
}

// A half turn has no shape of its own: the program that calibrated decides.
TEST_F(PresentationTest, ExifDoesNotTurnImagesOfStructureFromMotion) {
    calibrate(16, 8);
    write_images(test::jpeg(test::exif(3, true), 16, 8));
    training::Rig rig = read();
    EXPECT_FALSE(rig.shots[0].image.as_stored);
    rig.remarks.clear();
    rig.images_as_stored = true;
    training::settle_presentation(rig);
    EXPECT_TRUE(rig.shots[0].image.as_stored);
    EXPECT_NE(remarks(rig).find("used as stored"), std::string::npos) << remarks(rig);
}

TEST_F(PresentationTest, TheShapeOfTheCalibrationDecides) {
    calibrate(32, 16);  // twice as large
    write_images(test::jpeg(test::exif(8, false), 16, 8));
    const training::Rig rig = read();
    EXPECT_TRUE(rig.shots[0].image.as_stored);
    EXPECT_EQ(rig.cameras[0].lens.width, 16u);
    EXPECT_NE(remarks(rig).find("images not turned by 270° clockwise"), std::string::npos) << remarks(rig);
}

TEST_F(PresentationTest, VideosAreTurnedAndFramesGoByTheirTime) {
    calibrate(64, 48);
    const VideoFile even{{0, 40, 80, 120, 160, 200}};
    VideoFile dropped{{0, 40, 120, 160, 200}};
    dropped.matrix = {-(1 << 16), 0, 0, 0, -(1 << 16), 0, 0, 0, 1 << 30};
    write_videos(even, dropped, {{0, 20, 40, 60, 80, 100, 120, 140, 160, 180, 200}});
    const training::Rig rig = read();
    EXPECT_EQ(rig.fps, 25);
    std::vector<std::string> names;
    for (const training::Shot& shot : rig.shots) names.push_back(shot.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"02_000000", "02_000001", "02_000003", "02_000004", "02_000005", "03_000000",
                                        "03_000001", "03_000002", "03_000003", "03_000004", "03_000005"}));
    EXPECT_EQ(rig.shots[2].image.video_frame, 2);
    EXPECT_DOUBLE_EQ(rig.shots[2].time, 0.6);
    EXPECT_EQ(rig.shots[7].image.video_frame, 4);
    EXPECT_EQ(remarks(rig),
              "camera 03: 50 frames a second, in a clip of 25, for which the images between are left out\n"
              "camera 02: no image at frame 2\n"
              "camera 02: video shown turned by 180°, as the file says\n");
}

// 48×48 pixels that players show as 64×48, and a calibration for those.
TEST_F(PresentationTest, PixelsThatAreNotSquareHaveFocalLengthsOfTheirOwn) {
    calibrate(64, 48);
    VideoFile narrow{{0, 40}};
    narrow.width = 48;
    narrow.pixel_aspect = {4, 3};
    write_videos(narrow, narrow, narrow);
    const training::Rig rig = read();
    EXPECT_EQ(rig.cameras[0].lens.width, 48u);
    EXPECT_NEAR(rig.cameras[0].lens.fx, 90 * 0.75, 1e-9);
    EXPECT_NEAR(rig.cameras[0].lens.fy, 90, 1e-9);
    EXPECT_NE(remarks(rig).find("cameras 02, 03: video pixels 1.333 times as wide"), std::string::npos) << remarks(rig);
    narrow.pixel_aspect = {1, 1};
    write_videos(narrow, narrow, narrow);
    expect_input_error([&] { read(); }, {"01.mp4", "48×48", "another shape"});
}

// A file whose header is not what the calibration says is refused before its pixels are looked at.
TEST_F(PresentationTest, SizesAreComparedBeforeAnythingIsDecoded) {
    calibrate(16, 8);
    write_images(test::jpeg("", 16, 8));
    const std::string large = test::jpeg("", 1600, 800);
    write_text(folder.path / "images/02/000001.jpg", large.substr(0, large.size() / 2));  // its header is whole
    write_text(folder.path / "images/03/000001.jpg", test::jpeg("", 16, 8));
    expect_input_error([&] { training::read_images(read(), {.mattes_needed = false}); },
                       {"000001.jpg", "is 1600×800", "16×8"});
}

}  // namespace
}  // namespace neuvv
