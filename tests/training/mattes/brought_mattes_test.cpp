// Which file of another program is the matte of which image.
#include "training/mattes/brought_mattes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/platform.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using training::find_brought_mattes;
namespace fs = std::filesystem;

struct BroughtMattes : ::testing::Test {
    TemporaryFolder folder;
    fs::path mattes = folder.path / "from";
    training::Rig rig;

    // Two cameras of three images each, whose files have the same names.
    BroughtMattes() {
        fs::create_directories(mattes);
        rig.folder = folder.path / "studio";
        for (uint32_t camera = 0; camera < 2; ++camera) {
            const std::string name = camera == 0 ? "left" : "right";
            rig.cameras.push_back({.name = name});
            for (int frame = 0; frame < 3; ++frame) {
                const std::string file = "000" + std::to_string(frame);
                rig.shots.push_back({.camera = camera,
                                     .time = frame / 2.0,
                                     .name = fmt::format("images_{}_{}", name, file),
                                     .image = {rig.folder / "images" / name / (file + ".jpg")}});
            }
        }
    }
    void put(const fs::path& name) const {
        fs::create_directories((mattes / name).parent_path());
        write_text(mattes / name, "matte");
    }
    void take_all() const {
        fs::remove_all(mattes);
        fs::create_directories(mattes);
    }
    // The file that is found for the first image of the second camera, relative to the folder.
    std::string of_right() const {
        return find_brought_mattes(mattes, {rig})[0][3].path.lexically_relative(mattes).generic_string();
    }
};

TEST_F(BroughtMattes, AreNamedAsOtherProgramsNameThem) {
    for (const std::string& pattern :
         {std::string("images_CAMERA_NAME.png"), std::string("CAMERA/NAME.png"), std::string("CAMERA/NAME.jpg"),
          std::string("CAMERA/NAME.jpg.png"), std::string("images/CAMERA/NAME.jpg.png"), std::string("CAMERA_NAME.png"),
          std::string("CAMERA-NAME.jpeg")}) {
        take_all();
        std::string first;
        for (const training::Shot& shot : rig.shots) {
            std::string name = pattern;
            name.replace(name.find("CAMERA"), 6, rig.cameras[shot.camera].name);
            name.replace(name.find("NAME"), 4, shot.image.path.stem().string());
            put(name);
            if (first.empty() && shot.camera == 1) first = name;
        }
        EXPECT_EQ(of_right(), first);
    }
}

TEST_F(BroughtMattes, OfOneCameraDoNotServeAnother) {
    for (const char* name : {"0000.png", "0001.png", "0002.png"}) put(name);
    expect_input_error([&] { find_brought_mattes(mattes, {rig}); },
                       {"0000.png", "left/0000.jpg", "right/0000.jpg", "folders named after their cameras"});
    rig.shots.resize(3);
    EXPECT_EQ(find_brought_mattes(mattes, {rig})[0][2].path, mattes / "0002.png") << "one camera alone needs no folder";
}

TEST_F(BroughtMattes, OfAnImageServeItInBothSplits) {
    rig.shots.resize(3);
    for (const char* name : {"0000.png", "0001.png", "0002.png"}) put(name);
    EXPECT_EQ(find_brought_mattes(mattes, {rig, rig})[1][1].path, mattes / "0001.png");
}

TEST_F(BroughtMattes, OfAVideoAreItsFramesInOrderOfTime) {
    put("left.mp4");
    put("right.mov");
    std::swap(rig.shots[3].time, rig.shots[5].time);
    const std::vector<training::ImageSource> found = find_brought_mattes(mattes, {rig})[0];
    EXPECT_EQ(found[1].path, mattes / "left.mp4");
    EXPECT_EQ(found[1].video_frame, 1);
    EXPECT_EQ(found[3].path, mattes / "right.mov");
    EXPECT_EQ(found[3].video_frame, 2);
    EXPECT_EQ(found[5].video_frame, 0);
    for (training::Shot& shot : rig.shots) shot.image = {rig.folder / "a.mp4", 7 + (&shot - rig.shots.data())};
    EXPECT_EQ(find_brought_mattes(mattes, {rig})[0][1].video_frame, 8) << "that of the image in its own video";
}

TEST_F(BroughtMattes, ThatAreMissingAreNamed) {
    put("left/0000.png");
    expect_input_error([&] { find_brought_mattes(mattes, {rig}); }, {"images_left_0001", "there is no matte"});
    expect_input_error([&] { find_brought_mattes(folder.path / "none", {rig}); }, {"none", "no folder"});
}

}  // namespace
}  // namespace neuvv::test
