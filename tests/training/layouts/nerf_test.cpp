// Data sets as D-NeRF, nerfstudio and instant-ngp write them.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "media/video.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using nlohmann::json;

// An image of 10×8 pixels, opaque on the left; `red` makes images differ.
media::Image image(uint8_t red) {
    media::Image image(10, 8);
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 10; ++x) {
            const uint8_t pixel[4] = {red, 40, 90, static_cast<uint8_t>(x < 5 ? 255 : 0)};
            std::copy(pixel, pixel + 4, image.at(x, y));
        }
    return image;
}

// A level camera at (x, −3, 1) that looks along +Y in a world with +Z up.
json z_up_pose(double x) {
    return {{1, 0, 0, x}, {0, 0, -1, -3}, {0, 1, 0, 1}, {0, 0, 0, 1}};
}

struct NerfTest : testing::Test {
    TemporaryFolder folder;

    void put(const std::string& name, const media::Image& image) {
        std::filesystem::create_directories((folder.path / name).parent_path());
        media::write_png(folder.path / name, image);
    }
    void put(const std::string& name, const json& document) { write_text(folder.path / name, document.dump()); }
    void expect_bad(const json& document, const std::function<void(json&)>& damage,
                    std::initializer_list<std::string> parts) {
        json damaged = document;
        damage(damaged);
        put("transforms.json", damaged);
        expect_input_error([&] { training::read_nerf_rig(folder.path, training::Split::kTrain); }, parts);
    }
};

// Expects the camera of z_up_pose(x) in a world with +Y up: at (x, 1, 3), looking along −Z.
void expect_level(const glm::dmat4& pose, double x) {
    const glm::dmat4 expected(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0),
                              glm::dvec4(x, 1, 3, 1));
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) EXPECT_NEAR(pose[column][row], expected[column][row], 1e-12);
}

// One camera that moves, with one image per time. file_path has no extension, and a folder has the name of an image.
TEST_F(NerfTest, DNerf) {
    for (const char* split : {"train", "val", "test"}) {
        json document = {{"camera_angle_x", 0.7}};
        for (int i = 0; i < 3; ++i) {
            const std::string path = std::string(split) + "/r_00" + std::to_string(i);
            put(path + ".png", image(static_cast<uint8_t>(split[0] + i)));
            document["frames"].push_back(
                {{"file_path", "./" + path}, {"rotation", 0.3}, {"time", i / 2.0}, {"transform_matrix", z_up_pose(i)}});
        }
        put(std::string("transforms_") + split + ".json", document);
    }
    std::filesystem::create_directories(folder.path / "train" / "r_001");
    const training::Dataset train = training::load_dataset(folder.path, training::Split::kTrain);
    ASSERT_EQ(train.views.size(), 3u);
    ASSERT_EQ(train.cameras.size(), 3u);
    EXPECT_EQ(train.times, (std::vector<double>{0, 0.5, 1}));
    EXPECT_EQ(train.views[2].image.at(0, 0)[0], 't' + 2);
    EXPECT_NEAR(train.cameras[1].fx, 5 / std::tan(0.35), 1e-12);
    EXPECT_EQ(train.cameras[1].cx, 5);
    EXPECT_EQ(train.cameras[1].cy, 4);
    expect_level(train.cameras[1].world_from_camera, 1);
    EXPECT_EQ(train.views[1].name, "train_r_001") << "the other splits have an r_001, too";
    const training::Dataset val = training::load_dataset(folder.path, training::Split::kVal);
    EXPECT_EQ(val.views[0].name, "val_r_000");
    EXPECT_EQ(val.views[0].image.at(0, 0)[0], 'v');
    EXPECT_EQ(training::load_dataset(folder.path, training::Split::kTest).views[2].name, "test_r_002");

    put("transforms_test.json", json{{"frames", 3}});
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTest); }, {"transforms_test.json"});
    std::filesystem::remove(folder.path / "transforms_val.json");
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kVal); }, {"transforms_val.json"});
}

struct Nerfstudio : NerfTest {
    json good = {{"camera_model", "OPENCV"},
                 {"w", 10},
                 {"h", 8},
                 {"fl_x", 12.0},
                 {"fl_y", 11.0},
                 {"cx", 5.25},
                 {"cy", 4.5},
                 {"k1", 0.03},
                 {"k2", -0.004},
                 {"p1", 0.001},
                 {"p2", -0.002},
                 {"k3", 0.001}};

    void SetUp() override {
        for (int i = 0; i < 9; ++i) {
            const std::string name = "frame_" + std::to_string(i);
            put("images/" + name + ".png", image(static_cast<uint8_t>(10 * i)));
            media::Image mask(10, 8);
            for (size_t k = 0; k < mask.rgba.size(); ++k)
                mask.rgba[k] = k % 4 == 3 || k >= 40 ? 255 : 0;  // row 0 black
            put("masks/" + name + ".png", mask);
            good["frames"].push_back({{"file_path", "images/" + name + ".png"},
                                      {"mask_path", "masks/" + name + ".png"},
                                      {"transform_matrix", z_up_pose(i)},
                                      {"colmap_im_id", i}});
        }
        good["frames"][3]["fl_x"] = 13.0;
        good["applied_transform"] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}};
    }
    training::Rig rig(training::Split split = training::Split::kTrain) {
        put("transforms.json", good);
        return training::read_rig(folder.path, split);
    }
};

TEST_F(Nerfstudio, LensesAndPoses) {
    const training::Rig train = rig(), test = rig(training::Split::kTest);
    ASSERT_EQ(train.cameras.size(), 7u);
    ASSERT_EQ(test.cameras.size(), 2u);  // the first and the ninth
    expect_level(test.cameras[1].world_from_camera, 8);
    const interchange::Lens& lens = test.cameras[0].lens;
    EXPECT_EQ(lens.model, interchange::LensModel::kBrown);
    EXPECT_EQ(lens.fx, 12);
    EXPECT_EQ(lens.fy, 11);
    EXPECT_EQ(lens.cx, 5.25);
    EXPECT_EQ(lens.cy, 4.5);
    EXPECT_EQ(lens.k, (std::array<double, 6>{0.03, -0.004, 0.001}));
    EXPECT_EQ(lens.p1, 0.001);
    EXPECT_EQ(lens.p2, -0.002);
    EXPECT_EQ(train.cameras[2].lens.fx, 13) << "a frame's own focal length";
    EXPECT_EQ(train.masks, training::MaskMeaning::kUsable);
    EXPECT_EQ(train.shots[2].name, "frame_3");

    const training::Dataset data = training::load_dataset(folder.path, training::Split::kTrain);
    EXPECT_TRUE(data.views[0].ignores(5, 0));
    EXPECT_FALSE(data.views[0].ignores(5, 4));
    EXPECT_EQ(data.cameras[0].fx, 12);

    good["camera_model"] = "OPENCV_FISHEYE";
    good["p1"] = good["p2"] = 0;
    good["k4"] = 0.002;
    EXPECT_EQ(rig().cameras[0].lens.model, interchange::LensModel::kFisheye);
    EXPECT_EQ(rig().cameras[0].lens.k[3], 0.002);
    good["camera_model"] = "PINHOLE";
    for (const char* key : {"k1", "k2", "k3", "k4"}) good.erase(key);
    EXPECT_FALSE(rig().cameras[0].lens.distorts());
}

TEST_F(Nerfstudio, AppliedScaleIsDividedOut) {
    good["applied_scale"] = 0.5;
    good["aabb"] = {{-1, -2, -3}, {1, 2, 4}};
    const training::Rig data = rig();
    EXPECT_EQ(glm::dvec3(data.cameras[0].world_from_camera[3]), glm::dvec3(2, 2, 6));
    EXPECT_EQ(data.box->first, glm::dvec3(-2, -6, -4));
    EXPECT_EQ(data.box->second, glm::dvec3(2, 8, 4));
    expect_bad(good, [](json& j) { j["applied_scale"] = 0; }, {"applied_scale"});
}

TEST_F(Nerfstudio, ListsDivideTheSplits) {
    good["train_filenames"] = {"images/frame_1.png", "./images/frame_2.png"};
    good["test_filenames"] = {"images/frame_0.png"};
    good["val_filenames"] = {"images/frame_7.png"};
    EXPECT_EQ(rig().shots.size(), 2u);
    EXPECT_EQ(rig().shots[1].name, "frame_2");
    EXPECT_EQ(rig(training::Split::kTest).shots.at(0).name, "frame_0");
    EXPECT_EQ(rig(training::Split::kVal).shots.at(0).name, "frame_7");
    expect_bad(good, [](json& j) { j["test_filenames"].push_back("images/frame_1.png"); },
               {"frame_1.png", "train_filenames", "test_filenames"});
    good["val_filenames"] = good["test_filenames"];
    EXPECT_EQ(rig(training::Split::kVal).shots.at(0).name, "frame_0") << "images of the test may be of the validation";
    EXPECT_EQ(rig(training::Split::kTest).shots.size(), 1u);
    expect_bad(good, [](json& j) { j["train_filenames"].push_back("images/frame_99.png"); }, {"frame_99.png"});
    expect_bad(good, [](json& j) { j.erase("train_filenames"); }, {"train_filenames", "missing"});
    expect_bad(good, [](json& j) { j["val_filenames"] = {1}; }, {"val_filenames[0]", "string"});
    for (const char* key : {"train_filenames", "test_filenames", "val_filenames"}) good.erase(key);
    expect_input_error([&] { rig(training::Split::kVal); }, {"transforms.json", "no validation split"});
}

TEST_F(Nerfstudio, MasksAreOfAllFramesOrNone) {
    expect_bad(good, [](json& j) { j["frames"][3].erase("mask_path"); }, {"frames[3]", "mask_path"});
    expect_bad(good, [](json& j) { j["frames"][3]["mask_path"] = "no.png"; }, {"frames[3].mask_path", "no.png"});
    expect_bad(good, [](json& j) { j["frames"][3]["mask_path"] = "../no.png"; }, {"frames[3].mask_path", ".."});
}

TEST_F(NerfTest, InstantNgp) {
    std::string frames;
    for (int i = 0; i < 4; ++i) {
        put("images/" + std::to_string(i) + ".png", image(static_cast<uint8_t>(10 * i)));
        frames += (i ? "," : "") + json{{"file_path", "./images/" + std::to_string(i) + ".png"},
                                        {"sharpness", 23.5},
                                        {"transform_matrix", z_up_pose(i)},
                                        {"fl_x", 20.0 + i}}
                                       .dump();
    }
    media::Image mask(10, 8);
    for (size_t k = 0; k < 4 * 10; ++k) mask.rgba[k] = 255;  // row 0 moves
    for (size_t k = 3; k < mask.rgba.size(); k += 4) mask.rgba[k] = 255;
    put("images/dynamic_mask_2.png", mask);
    write_text(folder.path / "transforms.json",
               "{ // as colmap2nerf writes it, and a hand's comment\n"
               "\"camera_angle_x\": 0.5, \"camera_angle_y\": 0.4, \"w\": 10.0, \"h\": 8.0, \"cx\": 5.1, \"cy\": 4.2,\n"
               "\"k1\": 0.02, \"k2\": 0, \"k3\": 0, \"k4\": 0, \"p1\": 0.001, \"p2\": 0, \"is_fisheye\": false,\n"
               "\"aabb_scale\": 4, \"scale\": 0.25, \"offset\": [0.5, 0.25, 0.75], \"aabb\": [[0, 0, 0], [1, 1, 1]],\n"
               "/* frames */ \"frames\": [" +
                   frames + "]}");
    put("other.json", json{{"frames", json::array({1})}});  // this JSON is no data set
    const training::Rig rig = training::read_rig(folder.path, training::Split::kTrain);
    ASSERT_EQ(rig.shots.size(), 3u);
    expect_level(rig.cameras[1].world_from_camera, 2);
    EXPECT_EQ(rig.cameras[1].lens.fx, 22);
    EXPECT_EQ(rig.cameras[1].lens.fy, 22);
    EXPECT_EQ(rig.cameras[1].lens.k[0], 0.02);
    EXPECT_EQ(rig.masks, training::MaskMeaning::kIgnore);
    // instant-ngp maps p to cycle(p · scale + offset), where cycle takes (x, y, z) to (y, z, x). The corners of its
    // cube are (−½, −¼, −¾) / scale and (½, ¾, ¼) / scale, which are then turned to +Y up.
    ASSERT_TRUE(rig.box);
    EXPECT_EQ(rig.box->first, glm::dvec3(-2, -3, -3));
    EXPECT_EQ(rig.box->second, glm::dvec3(2, 1, 1));
    const training::Dataset data = training::load_dataset(folder.path, training::Split::kTrain);
    EXPECT_TRUE(data.views[1].ignores(5, 0));
    EXPECT_FALSE(data.views[1].ignores(5, 4));
    EXPECT_FALSE(data.views[0].ignores(5, 0));
}

// A multi-view video: each frame names a folder of images, or a video, of its camera.
struct Sequences : NerfTest {
    json document = {{"camera_model", "OPENCV_FISHEYE"}, {"w", 10}, {"h", 8}, {"fl_x", 12.0}, {"k1", 0.01}};

    void SetUp() override {
        for (int i = 0; i < 3; ++i) {
            const std::string camera = "cam" + std::to_string(i);
            for (int frame = 8; frame < 11; ++frame) {
                const std::string name = "/" + std::to_string(frame) + ".png";
                if (i != 1 || frame != 8)
                    put(fmt::format("images/{}{}", camera, name), image(static_cast<uint8_t>(10 * i + frame)));
                put(fmt::format("masks/{}{}", camera, name), media::Image(10, 8));
            }
            document["frames"].push_back({{"file_path", "images/" + camera}, {"transform_matrix", z_up_pose(i)}});
        }
    }
    training::Rig rig(training::Split split = training::Split::kTrain) {
        put("transforms.json", document);
        return training::read_rig(folder.path, split);
    }
};

TEST_F(Sequences, AFolderHasTheFramesOfItsCamera) {
    const training::Rig train = rig(), test = rig(training::Split::kTest);
    ASSERT_EQ(train.cameras.size(), 2u);
    EXPECT_EQ(train.cameras[0].lens.model, interchange::LensModel::kFisheye);
    ASSERT_EQ(train.shots.size(), 5u);
    EXPECT_EQ(train.shots[0].name, "images_cam1_9");
    EXPECT_EQ(train.shots[0].time, 0.5) << "cam1 has no frame 8, and others have: the same as in the test split";
    EXPECT_EQ(train.shots[1].time, 1) << "10 comes after 9";
    EXPECT_EQ(train.shots[1].image.path, folder.path / "images" / "cam1" / "10.png");
    EXPECT_EQ(train.shots[2].time, 0);
    EXPECT_EQ(test.shots.at(1).time, 0.5);
    for (int i = 0; i < 3; ++i) document["frames"][i]["mask_path"] = "masks/cam" + std::to_string(i);
    const training::Rig masked = rig();
    EXPECT_EQ(masked.masks, training::MaskMeaning::kUsable);
    EXPECT_EQ(masked.shots[1].mask.path, folder.path / "masks" / "cam1" / "10.png");
}

TEST_F(Sequences, AVideoHasTheFramesOfItsCamera) {
    for (int i = 0; i < 3; ++i) {
        const std::string name = "cam" + std::to_string(i) + ".mp4";
        media::VideoWriter writer(folder.path / name, 10, 8, 25);
        for (int frame = 0; frame < 3; ++frame) writer.add(image(100));
        writer.finish();
        document["frames"][i]["file_path"] = name;
    }
    const training::Rig train = rig();
    ASSERT_EQ(train.shots.size(), 6u);
    EXPECT_EQ(train.shots[4].name, "cam2_000001");
    EXPECT_EQ(train.shots[4].image.video_frame, 1);
    EXPECT_EQ(train.shots[4].time, 0.5);
    EXPECT_EQ(train.fps, 25);
}

// The same as single images, a frame each, and none with a time.
TEST_F(Sequences, FramesWithoutTimesAreTimedByName) {
    json frames = json::array();
    for (int i = 0; i < 3; ++i)
        for (const char* name : {"/9", "/10"})
            frames.push_back(
                {{"file_path", "images/cam" + std::to_string(i) + name}, {"transform_matrix", z_up_pose(i)}});
    document["frames"] = frames;
    const training::Rig train = rig();
    ASSERT_EQ(train.shots.size(), 4u);
    EXPECT_EQ(train.shots[2].time, 0);
    EXPECT_EQ(train.shots[3].time, 1);
    for (int i = 0; i < 6; ++i) put("flat/c" + std::to_string(i) + ".png", image(100));
    for (size_t i = 0; i < 6; ++i) document["frames"][i]["file_path"] = "flat/c" + std::to_string(i);
    expect_input_error([&] { rig(); }, {"transforms.json", "no time", "a folder a camera"});
    for (size_t i = 0; i < 6; ++i) document["frames"][i]["time"] = static_cast<double>(i % 2);
    EXPECT_EQ(rig().shots.at(3).time, 1);
}

TEST_F(Sequences, WhatContradictsIsRefused) {
    document["frames"][1]["time"] = 0.5;
    expect_input_error([&] { rig(); }, {"frames[1].time", "many images"});
    document["frames"][1].erase("time");
    for (const int i : {0, 1, 2}) document["frames"][i]["file_path"] = "images/none";
    expect_input_error([&] { rig(); }, {"file_path", "images/none"});
    for (const int i : {0, 1, 2}) document["frames"][i]["file_path"] = "images/cam" + std::to_string(i);
    for (int i = 0; i < 3; ++i) document["frames"][i]["mask_path"] = "masks/cam" + std::to_string(i);
    std::filesystem::remove(folder.path / "masks" / "cam1" / "9.png");
    expect_input_error([&] { rig(); }, {"masks/cam1", "9.png"});
}

// The same images of validation and test are read once, so that they do not take each other's names.
TEST_F(NerfTest, TheValidationMayBeTheTest) {
    json train = {{"camera_angle_x", 0.7}}, test = train;
    for (int i = 0; i < 4; ++i) {
        const std::string path = "images/r_" + std::to_string(i);
        put(path + ".png", image(100));
        (i < 2 ? train : test)["frames"].push_back({{"file_path", path}, {"transform_matrix", z_up_pose(i)}});
    }
    put("transforms_train.json", train);
    put("transforms_test.json", test);
    put("transforms_val.json", test);
    for (const auto split : {training::Split::kTest, training::Split::kVal}) {
        const training::Rig rig = training::read_rig(folder.path, split);
        ASSERT_EQ(rig.shots.size(), 2u);
        EXPECT_EQ(rig.shots[0].name, "r_2");
        EXPECT_EQ(rig.cameras[1].name, "r_3");
        EXPECT_EQ(rig.poses.size(), 4u);
    }
}

// A split may have images of another one: they are stills, not a video.
TEST_F(NerfTest, ImagesOfTwoSplitsStayStills) {
    for (const char* split : {"train", "test"}) {
        json document = {{"camera_angle_x", 0.7}};
        for (int i = 0; i < 3; ++i) {
            const std::string path = "r_" + std::to_string(i);
            put(path + ".png", image(100));
            document["frames"].push_back({{"file_path", path}, {"transform_matrix", z_up_pose(i)}});
        }
        put(std::string("transforms_") + split + ".json", document);
    }
    for (const training::Shot& shot : training::read_rig(folder.path, training::Split::kTrain).shots)
        EXPECT_EQ(shot.time, 0);
}

}  // namespace
}  // namespace neuvv
