// Which cameras are held out, what they are called, and their clean plates, in all layouts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "media/video.h"
#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "training/data/both_splits.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/rig/holdout.h"
#include "training/data/matte_sources.h"

namespace neuvv {
namespace {

using nlohmann::json;
using training::Split;
using Names = std::vector<std::string>;

// The names of those held out, with spaces between.
std::string held(const Names& cameras, const std::string& holdout) {
    const std::vector<bool> flags = training::held_out(cameras, holdout);
    std::string text;
    for (size_t i = 0; i < cameras.size(); ++i)
        if (flags[i]) text += (text.empty() ? "" : " ") + cameras[i];
    return text;
}

TEST(Holdout, ByNumberShareOrName) {
    const Names cameras = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"};
    EXPECT_EQ(held(cameras, "0"), "");
    EXPECT_EQ(held(cameras, "1"), "a");
    EXPECT_EQ(held(cameras, "2"), "a f");
    EXPECT_EQ(held(cameras, "10"), "a b c d e f g h i j");
    EXPECT_EQ(held(cameras, "20%"), "a f");
    EXPECT_EQ(held(cameras, "0.2"), "a f");
    EXPECT_EQ(held(cameras, "1%"), "a") << "a share holds out one at least";
    EXPECT_EQ(held(cameras, "0%"), "");
    EXPECT_EQ(held(cameras, "c"), "c");
    EXPECT_EQ(held(cameras, "j, b"), "b j");
    for (const char* bad : {"11", "100%", "-1", "1.5", "nobody", "a,nobody"})
        expect_input_error([&] { held(cameras, bad); },
                           {"holdout: ", std::string(bad).ends_with("nobody") ? "nobody" : bad});
    for (const char* bad : {"100%", "-1", "1.5"})
        expect_input_error([&] { held(cameras, bad); }, {"is no share from 0 % to below 100 %", "from 0 to 10,"});
}

TEST(Holdout, NamesThatAreNumbers) {
    EXPECT_EQ(held({"26578", "26579", "26580"}, "26579"), "26579") << "more than there are cameras: a serial number";
    EXPECT_EQ(held({"01", "02", "03"}, "02"), "02");
    EXPECT_EQ(held({"0", "1", "2"}, "2"), "0 1") << "a number of cameras";
    EXPECT_EQ(held({"0", "1", "2"}, "2,"), "2");
    EXPECT_EQ(held({"rig/0", "rig/1", "side/0"}, "rig"), "rig/0 rig/1");
}

struct Splits : testing::Test {
    TemporaryFolder folder;
    Names names = {"cam01", "cam02", "cam03"};

    // EasyMocap's layout, whose first camera is held out.
    void write_easymocap() const {
        std::string intrinsics = test::yaml_names(names), extrinsics = intrinsics;
        for (size_t i = 0; i < names.size(); ++i) {
            intrinsics += test::yaml_matrix("K_" + names[i], 3, 3, {90, 0, 31, 0, 95, 22, 0, 0, 1});
            extrinsics += test::yaml_matrix("R_" + names[i], 3, 1, {0, 0, 0});
            extrinsics += test::yaml_matrix("T_" + names[i], 3, 1, {1.0 * static_cast<double>(i), 0, 4});
            for (int frame = 0; frame < 2; ++frame)
                test::write_grey_png(folder.path / "images" / names[i] / fmt::format("{}.png", frame), 64, 48);
        }
        write_text(folder.path / "intri.yml", intrinsics);
        write_text(folder.path / "extri.yml", extrinsics);
    }
    std::string cameras(Split split, const std::string& holdout = "") const {
        std::string text;
        for (const training::RigCamera& camera : training::read_rig(folder.path, split, "auto", holdout).cameras)
            text += (text.empty() ? "" : " ") + camera.name;
        return text;
    }
    static json frame(const std::string& path, double x) {
        return {{"file_path", path}, {"transform_matrix", {{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}}};
    }
    void write_transforms(const std::string& file, const std::vector<std::pair<std::string, double>>& frames) const {
        json document = {{"fl_x", 60}};
        for (const auto& [path, x] : frames) {
            test::write_grey_png(folder.path / path, 64, 48);
            document["frames"].push_back(frame(path, x));
        }
        write_text(folder.path / file, document.dump());
    }
};

TEST_F(Splits, TheUserHoldsOutCamerasOfAnyLayout) {
    write_easymocap();
    EXPECT_EQ(cameras(Split::kTest), "cam01");
    EXPECT_EQ(cameras(Split::kTest, "cam03"), "cam03");
    EXPECT_EQ(cameras(Split::kTrain, "cam03"), "cam01 cam02");
    EXPECT_EQ(cameras(Split::kTrain, "0"), "cam01 cam02 cam03");
    expect_input_error([&] { cameras(Split::kTest, "0"); }, {"holdout: ", "holds out no camera", "from 1 to 2,"});
    expect_input_error([&] { cameras(Split::kTrain, "3"); }, {"holdout: ", "leaves no camera", "from 0 to 2,"});
    const training::Rig train = training::read_rig(folder.path, Split::kTrain, "auto", "cam02");
    ASSERT_EQ(train.shots.size(), 4u);
    EXPECT_EQ(train.shots[3].time, 1);
}

TEST_F(Splits, WhereNoImageIsFoundWhatIsThereIsNamed) {
    write_easymocap();
    std::filesystem::remove_all(folder.path / "images");
    for (int i = 0; i < 6; ++i) write_text(folder.path / "images" / fmt::format("shot{}.tif", i), "");
    expect_input_error(
        [&] { cameras(Split::kTrain); },
        {"no image of any camera of intri.yml (cam01, cam02, cam03): it holds extri.yml, images/, intri.yml",
         "images/ holds shot0.tif, shot1.tif, shot2.tif, shot3.tif and 2 more", "images/<camera>/"});
    std::filesystem::remove_all(folder.path / "images");
    std::filesystem::create_directories(folder.path / "images");
    expect_input_error([&] { cameras(Split::kTrain); }, {"images/ holds nothing"});
}

TEST_F(Splits, OneCameraMayBeTrained) {
    names = {"only"};
    write_easymocap();
    expect_input_error([&] { cameras(Split::kTrain); }, {"hold none out"});
    EXPECT_EQ(cameras(Split::kTrain, "0"), "only");
}

TEST_F(Splits, FilesOfSplitsGiveWayToTheUser) {
    write_transforms("transforms_train.json", {{"train/a_0.png", 0}, {"train/b_0.png", 1}});
    write_transforms("transforms_test.json", {{"test/c_0.png", 2}});
    EXPECT_EQ(cameras(Split::kTrain), "a_0 b_0");
    EXPECT_EQ(cameras(Split::kTrain, "b_0"), "a_0 c_0");
    EXPECT_EQ(cameras(Split::kTest, "b_0"), "b_0");
    EXPECT_EQ(cameras(Split::kTrain, "0"), "a_0 b_0 c_0");
    expect_input_error([&] { cameras(Split::kVal, "1"); }, {"no validation split"});
}

TEST_F(Splits, CamerasAreCalledAsTheirFiles) {
    write_transforms("transforms.json", {{"images/left/0.png", 0},
                                         {"images/left/1.png", 0},
                                         {"images/right/0.png", 1},
                                         {"images/right/1.png", 1},
                                         {"images/top/0.png", 2},
                                         {"images/top/1.png", 2}});
    EXPECT_EQ(cameras(Split::kTrain), "right top") << "a folder a camera";
    EXPECT_EQ(cameras(Split::kTest), "left") << "alone in its split as well";
    const training::Dataset test =
        training::load_dataset(folder.path, Split::kTest, {.mattes_needed = false, .may_be_empty = true});
    EXPECT_EQ(test.camera_names, Names{"left"});

    write_transforms("transforms.json",
                     {{"all/c0_f0.png", 0}, {"all/c0_f1.png", 0}, {"all/c1_f0.png", 1}, {"all/c1_f1.png", 1}});
    json document = json::parse(read_text(folder.path / "transforms.json"));
    for (size_t i = 0; i < 4; ++i) document["frames"][i]["time"] = i % 2;
    write_text(folder.path / "transforms.json", document.dump());
    EXPECT_EQ(cameras(Split::kTrain), "c1");

    std::filesystem::remove(folder.path / "transforms.json");
    write_transforms("transforms_train.json", {{"train/r_0.png", 0}, {"train/r_1.png", 1}});
    write_transforms("transforms_test.json", {{"test/r_0.png", 2}});
    EXPECT_EQ(cameras(Split::kTrain), "train_r_0 train_r_1") << "D-NeRF calls images of both splits alike";
    EXPECT_EQ(cameras(Split::kTest), "test_r_0");
}

TEST_F(Splits, PlatesOfAnyLayout) {
    write_easymocap();
    test::write_grey_png(folder.path / "plates" / "cam02.PNG", 64, 48, 90);
    {
        media::VideoWriter writer(folder.path / "plates" / "empty_room_cam01.mp4", 64, 48, 25);
        for (int i = 0; i < 5; ++i) {
            media::Image image(64, 48);
            for (uint8_t& byte : image.rgba) byte = i == 2 ? 255 : 120;  // someone passes by
            writer.add(image);
        }
        writer.finish();
    }
    const training::Rig train = training::read_rig(folder.path, Split::kTrain);
    EXPECT_EQ(train.cameras[0].plate.path, folder.path / "plates" / "cam02.PNG");
    EXPECT_TRUE(train.cameras[1].plate.path.empty());
    EXPECT_EQ(train.remarks, (Names{"plates/ has no CAMERA.png of cam03"}));
    const training::Dataset test = training::load_dataset(folder.path, Split::kTest, {.mattes_needed = false});
    ASSERT_EQ(test.plates.at(0).width, 64u);
    EXPECT_NEAR(test.plates[0].at(20, 20)[0], 120, 3) << "the median of the video";

    write_transforms("transforms.json", {{"a.png", 0}, {"b.png", 1}});
    json document = json::parse(read_text(folder.path / "transforms.json"));
    document["frames"][1]["background_path"] = "a.png";
    write_text(folder.path / "transforms.json", document.dump());
    test::write_grey_png(folder.path / "plates" / "b.png", 64, 48);
    const training::Rig named = training::read_rig(folder.path, Split::kTrain, "nerf");
    EXPECT_EQ(named.cameras.at(0).plate.path, folder.path / "a.png") << "what the file says counts";
    EXPECT_EQ(named.remarks, (Names{"1 cameras have the plate that transforms.json names, not that of plates/"}));
}

TEST_F(Splits, WhatHasMattesIsKnown) {
    write_easymocap();
    const auto sources = [&] { return training::matte_sources(training::read_both_splits(folder.path, "auto").rigs); };
    EXPECT_TRUE(sources().empty());
    media::Image clear(64, 48);
    clear.at(3, 3)[3] = 255;
    for (const int frame : {0, 1})
        media::write_png(folder.path / "images" / "cam02" / fmt::format("{}.png", frame), clear);
    EXPECT_EQ(sources(), (Names{"the alpha of the images"}));
    for (const std::string& name : names)
        for (const int frame : {0, 1})
            test::write_grey_png(folder.path / "masks" / name / fmt::format("{}.png", frame), 64, 48, 255);
    test::write_grey_png(folder.path / "mattes" / "cam03_1.png", 64, 48, 255);
    EXPECT_EQ(sources(), (Names{"mattes/", "masks/", "the alpha of the images"}));
}

// Names of images once began with their cameras' in any case: mattes that somebody corrected then still count.
TEST_F(Splits, MattesOfFormerNamesCount) {
    write_easymocap();
    for (const std::string& name : names)
        for (const int frame : {0, 1}) {
            const std::filesystem::path images = folder.path / "images" / name;
            std::filesystem::rename(images / fmt::format("{}.png", frame),
                                    images / fmt::format("{}_{}.png", name, frame));
            test::write_grey_png(folder.path / "mattes" / fmt::format("{0}_{0}_{1}.png", name, frame), 64, 48, 200);
        }
    EXPECT_EQ(training::matte_sources(training::read_both_splits(folder.path, "auto").rigs), Names{"mattes/"});
    const training::Dataset dataset = training::load_dataset(folder.path, Split::kTrain);
    EXPECT_EQ(dataset.views.at(0).name.find(dataset.camera_names.at(0) + "_" + dataset.camera_names.at(0)),
              std::string::npos);
    EXPECT_EQ(dataset.views.at(0).image.whole().at(5, 5)[3], 200);
    test::write_grey_png(folder.path / "mattes" / (dataset.views.at(0).name + ".png"), 64, 48, 100);
    EXPECT_EQ(training::load_dataset(folder.path, Split::kTrain).views.at(0).image.whole().at(5, 5)[3], 100);
}

}  // namespace
}  // namespace neuvv
