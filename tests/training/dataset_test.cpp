#include "training/data/dataset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/loaders.h"
#include "training/evaluation/evaluate.h"

namespace neuvv {
namespace {

using nlohmann::json;

json pose_at(double x, double y, double z) {
    return {{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}};
}

// An image with a matte: its columns are opaque, half clear and clear; `red` makes images differ.
media::Image matte_image(uint32_t width, uint32_t height, uint8_t red) {
    media::Image image(width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            uint8_t* pixel = image.at(x, y);
            pixel[0] = red;
            pixel[1] = static_cast<uint8_t>(40 * x);
            pixel[2] = static_cast<uint8_t>(40 * y);
            pixel[3] = x == 0 ? 255 : x == 1 ? 128 : 0;
        }
    return image;
}

// A sound data set of two cameras and three times, out of order, in which each test damages something.
struct DatasetTest : testing::Test {
    TemporaryFolder folder;
    json good;

    void SetUp() override {
        good = {{"camera_angle_x", 0.8}, {"w", 6}, {"h", 4}, {"fps", 12.5}, {"aabb", {{-1, 0, -1}, {1, 2, 1}}}};
        for (const int frame : {2, 0, 1})
            for (const int camera : {0, 1}) {
                const std::string name = "c" + std::to_string(camera) + "_f" + std::to_string(frame);
                good["frames"].push_back({{"file_path", "./train/" + name},
                                          {"time", frame / 2.0},
                                          {"transform_matrix", pose_at(camera, 1.5, 3)}});
                std::filesystem::create_directories(folder.path / "train");
                media::write_png(folder.path / "train" / (name + ".png"),
                                 matte_image(6, 4, static_cast<uint8_t>(10 * frame + 100 * camera)));
            }
    }

    training::Dataset load(const json& document, const char* name = "transforms_train.json",
                           training::Split split = training::Split::kTrain) {
        write_text(folder.path / name, document.dump());
        return training::load_dataset(folder.path, split);
    }
    void expect_bad(const std::function<void(json&)>& damage, std::initializer_list<std::string> parts) {
        json document = good;
        damage(document);
        expect_input_error([&] { load(document); }, parts);
    }
};

TEST_F(DatasetTest, GoodDataLoads) {
    const training::Dataset data = load(good);
    ASSERT_EQ(data.views.size(), 6u);
    ASSERT_EQ(data.cameras.size(), 2u);
    EXPECT_EQ(data.views[0].name, "c0_f2");
    EXPECT_EQ(data.views[3].name, "c1_f0");
    EXPECT_EQ(data.views[3].camera, 1u);
    EXPECT_EQ(data.views[3].time, 0);
    EXPECT_EQ(data.views[3].image.at(0, 0)[0], 100);
    EXPECT_EQ(data.times, (std::vector<double>{0, 0.5, 1}));
    EXPECT_EQ(data.fps, 12.5);
    ASSERT_TRUE(data.box);
    EXPECT_EQ(data.box->second, glm::dvec3(1, 2, 1));
    const stage::Camera& camera = data.cameras[1];
    EXPECT_EQ(glm::dvec3(camera.world_from_camera[3]), glm::dvec3(1, 1.5, 3));
    EXPECT_NEAR(camera.fx, 3 / std::tan(0.4), 1e-12);
    EXPECT_EQ(camera.fy, camera.fx);
    EXPECT_EQ(camera.cx, 3);
    EXPECT_EQ(camera.cy, 2);
    EXPECT_EQ(camera.width, 6u);
    EXPECT_EQ(camera.height, 4u);
}

TEST_F(DatasetTest, FocalLengthInPixelsEqualsAnAngle) {
    json pixels = good;
    pixels.erase("camera_angle_x");
    pixels["fl_x"] = 3 / std::tan(0.4);
    EXPECT_NEAR(load(pixels).cameras[0].fx, load(good).cameras[0].fx, 1e-12);
    EXPECT_NEAR(load(pixels).cameras[0].fy, load(good).cameras[0].fy, 1e-12);
    pixels["fl_y"] = 9;
    pixels["cx"] = 2.5;
    pixels["cy"] = 1.25;
    const stage::Camera camera = load(pixels).cameras[0];
    EXPECT_EQ(camera.fy, 9);
    EXPECT_EQ(camera.cx, 2.5);
    EXPECT_EQ(camera.cy, 1.25);
}

TEST_F(DatasetTest, AFramesOwnFieldsWin) {
    json document = good;
    document["frames"][1]["camera_angle_x"] = 1.2;
    const training::Dataset data = load(document);
    ASSERT_EQ(data.cameras.size(), 3u);  // a different lens makes a different camera
    EXPECT_NEAR(data.cameras[1].fx, 3 / std::tan(0.6), 1e-12);
}

TEST_F(DatasetTest, PathsMayNameTheirEnding) {
    json document = good;
    document["frames"][0]["file_path"] = "train/c0_f2.png";
    EXPECT_EQ(load(document).views[0].name, "c0_f2");
}

TEST_F(DatasetTest, FoldersTellImagesOfOneNameApart) {
    json document = good;
    std::filesystem::create_directories(folder.path / "b");
    std::filesystem::copy_file(folder.path / "train" / "c0_f2.png", folder.path / "b" / "c0_f2.png");
    document["frames"][1]["file_path"] = "./b/c0_f2";
    const training::Dataset data = load(document);
    EXPECT_EQ(data.views[0].name, "train_c0_f2");
    EXPECT_EQ(data.views[1].name, "b_c0_f2");
}

TEST_F(DatasetTest, OneFileHoldsOutEveryEighthCamera) {
    json document = {{"camera_angle_x", 0.8}};
    for (int camera = 0; camera < 10; ++camera) {
        const std::string name = "train/h" + std::to_string(camera);
        media::write_png(folder.path / (name + ".png"), matte_image(6, 4, 1));
        document["frames"].push_back({{"file_path", name}, {"transform_matrix", pose_at(camera, 0, 4)}});
    }
    const training::Dataset test = load(document, "transforms.json", training::Split::kTest);
    ASSERT_EQ(test.cameras.size(), 2u);
    EXPECT_EQ(test.cameras[0].world_from_camera[3].x, 0);
    EXPECT_EQ(test.cameras[1].world_from_camera[3].x, 8);
    EXPECT_EQ(load(document, "transforms.json", training::Split::kTrain).cameras.size(), 8u);

    document["frames"].erase(document["frames"].begin() + 1, document["frames"].end());
    expect_input_error([&] { load(document, "transforms.json", training::Split::kTest); },
                       {"transforms.json", "one camera"});
}

TEST_F(DatasetTest, MissingFilesAreNamed) {
    expect_input_error([&] { training::load_dataset(folder.path / "nowhere", training::Split::kTrain); }, {"nowhere"});
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTrain); },
                       {"transforms_train.json"});
    load(good);
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTest); }, {"transforms_test.json"});
}

// As in instant-ngp: a data set may list more images than there are.
TEST_F(DatasetTest, MissingImagesAreLeftOut) {
    std::filesystem::remove(folder.path / "train" / "c1_f0.png");
    const training::Dataset data = load(good);
    EXPECT_EQ(data.views.size(), 5u);
    EXPECT_EQ(data.remarks, (std::vector<std::string>{"1 of 6 images are not there, and are left out: train/c1_f0"}));
    for (const char* name : {"c0_f0", "c0_f1"})
        std::filesystem::remove(folder.path / "train" / (name + std::string(".png")));
    EXPECT_EQ(load(good).times, (std::vector<double>{0.5, 1})) << "half of them is enough";
    std::filesystem::remove(folder.path / "train" / "c0_f2.png");
    expect_input_error([&] { load(good); }, {"transforms_train.json", "frames[0].file_path", "c0_f2", "4 of 6 images"});
}

TEST_F(DatasetTest, TheLayoutIsRecognisedOrForced) {
    load(good);
    EXPECT_EQ(training::read_rig(folder.path, training::Split::kTrain).format, "nerf");
    EXPECT_EQ(training::load_dataset(folder.path, training::Split::kTrain, {.format = "nerf"}).views.size(), 6u);
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTrain, {.format = "nrf"}); },
                       {"format: ", "nerf"});
    const TemporaryFolder empty;
    expect_input_error([&] { training::load_dataset(empty.path, training::Split::kTrain); },
                       {"transforms.json", "(nerf)"});
    expect_input_error([&] { training::load_dataset(empty.path, training::Split::kTrain, {.format = "nerf"}); },
                       {"transforms.json"});
}

TEST_F(DatasetTest, TruncatedJsonAtEveryLength) {
    const std::string whole = good.dump();
    for (size_t length = 0; length < whole.size(); length += 7) {
        write_text(folder.path / "transforms_train.json", whole.substr(0, length));
        expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTrain); },
                           {"transforms_train.json"});
    }
}

TEST_F(DatasetTest, WrongTypesAreNamed) {
    expect_bad([](json& j) { j = json::array(); }, {"transforms_train.json", "object"});
    expect_bad([](json& j) { j.erase("frames"); }, {"no frames"});
    expect_bad([](json& j) { j["frames"] = json::array(); }, {"frames"});
    expect_bad([](json& j) { j["frames"] = 3; }, {"frames"});
    expect_bad([](json& j) { j["frames"][2] = "c0"; }, {"frames[2]", "object"});
    expect_bad([](json& j) { j["frames"][1]["file_path"] = 7; }, {"frames[1].file_path", "string"});
    expect_bad([](json& j) { j["frames"][1].erase("file_path"); }, {"frames[1]", "file_path"});
    expect_bad([](json& j) { j["frames"][1]["time"] = "now"; }, {"frames[1].time", "number"});
    expect_bad([](json& j) { j["camera_angle_x"] = json::array({1}); }, {"camera_angle_x", "number"});
    expect_bad([](json& j) { j.erase("camera_angle_x"); }, {"focal length"});
    expect_bad([](json& j) { j["frames"][4].erase("transform_matrix"); }, {"frames[4]", "transform_matrix"});
    expect_bad([](json& j) { j["frames"][4]["transform_matrix"] = 1; }, {"frames[4].transform_matrix"});
    expect_bad([](json& j) { j["frames"][4]["transform_matrix"][2] = {1, 2}; }, {"frames[4].transform_matrix[2]"});
    expect_bad([](json& j) { j["frames"][4]["transform_matrix"][2][1] = nullptr; }, {"transform_matrix[2][1]"});
    expect_bad([](json& j) { j["aabb"] = {{0, 0, 0}, {0, 1, 1}}; }, {"aabb", "not a box"});
    expect_bad([](json& j) { j["fps"] = -1; }, {"fps"});
}

TEST_F(DatasetTest, NumbersThatAreNone) {
    const std::string whole = good.dump();
    const size_t at = whole.find("1.5");
    ASSERT_NE(at, std::string::npos);
    for (const char* number : {"NaN", "nan", "Infinity", "-Infinity", "1e999", "-1e999", "0x10", "1,5"}) {
        write_text(folder.path / "transforms_train.json", whole.substr(0, at) + number + whole.substr(at + 3));
        expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTrain); },
                           {"transforms_train.json"});
    }
    for (const double angle : {0.0, -0.5, 3.2, 1e30})
        expect_bad([&](json& j) { j["camera_angle_x"] = angle; }, {"camera_angle_x"});
    for (const double focal : {0.0, -5.0, 1e30}) expect_bad([&](json& j) { j["fl_x"] = focal; }, {"fl_x"});
    for (const double time : {-0.1, 1.5})
        expect_bad([&](json& j) { j["frames"][0]["time"] = time; }, {"frames[0].time"});
}

TEST_F(DatasetTest, PosesMustBeRigid) {
    const auto with = [&](const json& pose, std::initializer_list<std::string> parts) {
        expect_bad([&](json& j) { j["frames"][3]["transform_matrix"] = pose; }, parts);
    };
    with({{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}, {"frames[3].transform_matrix", "scaled"});
    with({{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}}, {"frames[3].transform_matrix"});
    with({{1, 0.6, 0, 0}, {0, 0.8, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, {"sheared"});
    with({{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, {"left-handed"});
    with({{1, 0, 0, 1e9}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, {"from the origin"});
    with({{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {1, 2, 3, 1}}, {"0 0 0 1"});
}

TEST_F(DatasetTest, PathsStayInTheFolder) {
    for (const char* path : {"../c0_f2", "train/../../x", "/etc/passwd", ""})
        expect_bad([&](json& j) { j["frames"][0]["file_path"] = path; }, {"frames[0]"});
    expect_bad([](json& j) { j["frames"][0]["file_path"] = std::string("a\0b", 3); }, {"frames[0].file_path"});
}

TEST_F(DatasetTest, SizesMustAgree) {
    expect_bad([](json& j) { j["w"] = 0; }, {"w"});
    expect_bad([](json& j) { j["h"] = -4; }, {"h"});
    expect_bad([](json& j) { j["w"] = 1u << 20; }, {"w"});
    expect_bad([](json& j) { j.erase("h"); }, {"w and h"});
    expect_bad([](json& j) { j["w"] = 7; }, {"train/c", ".png", "6×4", "7×4"});
    media::write_png(folder.path / "train" / "c1_f1.png", matte_image(5, 4, 1));
    expect_bad([](json&) {}, {"c1_f1.png", "5×4"});
    expect_bad([](json& j) { j.erase("w"), j.erase("h"); }, {"c1_f1.png", "5×4"});
}

TEST_F(DatasetTest, ImagesMustBeWholePngs) {
    load(good);
    const auto path = folder.path / "train" / "c0_f1.png";
    const std::string whole = read_text(path);
    for (const std::string& bytes : {std::string(), whole.substr(0, 20), whole.substr(0, whole.size() - 20),
                                     whole.substr(0, 16) + std::string(8, '\0') + whole.substr(24)}) {
        write_text(path, bytes);
        expect_input_error([&] { load(good); }, {"c0_f1.png"});
    }
}

TEST_F(DatasetTest, AMatteIsNeeded) {
    const auto fill_alpha = [&](uint8_t alpha) {
        for (const auto& entry : std::filesystem::directory_iterator(folder.path / "train")) {
            media::Image image = media::read_png(entry.path());
            for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = alpha;
            media::write_png(entry.path(), image);
        }
    };
    fill_alpha(255);
    expect_bad([](json&) {}, {"matte", "RGBA"});
    fill_alpha(0);
    expect_bad([](json&) {}, {"alpha", "0"});
}

TEST_F(DatasetTest, FramesMustDiffer) {
    expect_bad([](json& j) { j["frames"][2]["file_path"] = j["frames"][0]["file_path"]; }, {"frames[2]", "frames[0]"});
    expect_bad([](json& j) { j["frames"][2]["time"] = j["frames"][0]["time"]; }, {"frames[2]", "frames[0]"});
    expect_bad([](json& j) { j["frames"][2].erase("time"); }, {"frames[2]", "time"});
}

TEST_F(DatasetTest, WhatALensDoesNotKnowIsRefused) {
    expect_bad([](json& j) { j["k4"] = 0.1; }, {"frames[0]", "k4", "OPENCV"});
    expect_bad([](json& j) { j["k1"] = "a"; }, {"k1", "number"});
    expect_bad([](json& j) { j["camera_model"] = "EQUIRECTANGULAR"; }, {"camera_model", "EQUIRECTANGULAR", "FISHEYE"});
    expect_bad([](json& j) { j["is_fisheye"] = true; }, {"fisheye", "fl_x"});
    expect_bad([](json& j) { j["is_fisheye"] = 1; }, {"is_fisheye"});
    expect_bad([](json& j) { j["is_fisheye"] = true, j["fl_x"] = 5, j["p1"] = 0.1; }, {"p1", "OPENCV_FISHEYE"});
    expect_bad([](json& j) { j["ftheta_p0"] = 0.1; }, {"ftheta_p0"});
    expect_bad([](json& j) { j["rolling_shutter"] = {0, 0, 0.1, 0}; }, {"rolling_shutter"});
    json harmless = good;
    harmless["k1"] = harmless["k4"] = harmless["p1"] = 0;
    harmless["rolling_shutter"] = {0, 0, 0, 0};
    EXPECT_EQ(load(harmless).views.size(), 6u);
}

TEST_F(DatasetTest, ForegroundWithoutAPlateIsStraightAlpha) {
    const training::Dataset data = load(good);
    const training::View& view = data.views[1];  // camera 1, time 2: red 120
    const auto linear = [](int byte) { return static_cast<float>(media::linear_from_srgb(byte / 255.0)); };
    EXPECT_EQ(training::foreground(data, view, 2, 3), glm::vec4(0));
    const glm::vec4 half = training::foreground(data, view, 1, 2);
    const float alpha = 128 / 255.0f;
    EXPECT_FLOAT_EQ(half.a, alpha);
    EXPECT_FLOAT_EQ(half.r, alpha * linear(120));
    EXPECT_FLOAT_EQ(half.g, alpha * linear(40));
    EXPECT_FLOAT_EQ(half.b, alpha * linear(80));
    const media::Image truth = training::truth_over(data, view);  // blends encoded values, as image viewers do
    EXPECT_NEAR(truth.at(1, 2)[0], 120 * alpha + 255 * (1 - alpha), 0.51);
    EXPECT_EQ(truth.at(3, 0)[0], 255);
}

// Images composited over a plate must give the same foreground colours as the images without one.
TEST_F(DatasetTest, APlateIsTakenOutOfTheImage) {
    const training::Dataset clear = load(good);
    json document = good;
    media::Image plate(6, 4);
    for (size_t i = 0; i < plate.rgba.size(); ++i)
        plate.rgba[i] = i % 4 == 3 ? 255 : static_cast<uint8_t>(50 + 7 * (i % 23));
    media::write_png(folder.path / "plate.png", plate);
    for (json& frame : document["frames"])
        if (frame["transform_matrix"][0][3] == 1) frame["background_path"] = "plate.png";
    for (const training::View& view : clear.views) {
        if (view.camera != 1) continue;
        media::Image captured = view.image.whole();
        for (uint32_t y = 0; y < 4; ++y)
            for (uint32_t x = 0; x < 6; ++x)
                for (int c = 0; c < 3; ++c) {
                    const glm::vec4 alone = training::foreground(clear, view, x, y);
                    const double behind = media::linear_from_srgb(plate.at(x, y)[c] / 255.0);
                    const double light = alone[c] + (1 - alone.a) * behind;
                    captured.at(x, y)[c] = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(light)));
                }
        media::write_png(folder.path / "train" / (view.name + ".png"), captured);
    }
    const training::Dataset data = load(document);
    ASSERT_EQ(data.plates.size(), 2u);
    EXPECT_EQ(data.plates[0].width, 0u);
    EXPECT_EQ(data.plates[1].rgba, plate.rgba);
    for (size_t i = 0; i < data.views.size(); ++i) {
        const media::Image expected = training::truth_over(clear, clear.views[i]),
                           truth = training::truth_over(data, data.views[i]);
        for (size_t b = 0; b < truth.rgba.size(); ++b) ASSERT_NEAR(truth.rgba[b], expected.rgba[b], 2) << i << " " << b;
    }

    document["frames"][1]["background_path"] = "other.png";
    expect_input_error([&] { load(document); }, {"frames[1]", "other.png"});
    document["frames"][1].erase("background_path");
    expect_input_error([&] { load(document); }, {"background_path"});
}

// This data set was made by other software, so that it shows wrong conventions.
TEST(RealData, TheMageStandsWhereItsCamerasLook) {
    const char* captures = std::getenv("NEUVV_TEST_DATA");
    if (!captures || !*captures) GTEST_SKIP() << "set NEUVV_TEST_DATA to a folder that holds the capture \"mage\"";
    const std::filesystem::path folder = std::filesystem::path(captures) / "mage";
    const training::Dataset data = training::load_dataset(folder, training::Split::kTest);
    EXPECT_EQ(data.cameras.size(), 4u);
    EXPECT_EQ(data.views.size(), 4u * 24);
    ASSERT_EQ(data.times.size(), 24u);
    EXPECT_EQ(data.times.front(), 0);
    EXPECT_EQ(data.times.back(), 1);
    ASSERT_TRUE(data.box);
    const glm::dvec3 centre = 0.5 * (data.box->first + data.box->second);
    for (const training::View& view : data.views) {
        const stage::Camera& camera = data.cameras[view.camera];
        const glm::dvec3 p(glm::inverse(camera.world_from_camera) * glm::dvec4(centre, 1));
        ASSERT_LT(p.z, 0);
        const double x = camera.cx - camera.fx * p.x / p.z, y = camera.cy + camera.fy * p.y / p.z;
        ASSERT_TRUE(x > 0 && x < camera.width && y > 0 && y < camera.height) << view.name;
        EXPECT_EQ(view.image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y))[3], 255) << view.name;
    }
}

}  // namespace
}  // namespace neuvv
