// Captures as Dynamic 3D Gaussians reads them.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using nlohmann::json;
using training::Split;

constexpr int kFrames = 3;

struct Dynamic3dgs : testing::Test {
    TemporaryFolder folder;
    json train = meta({"1", "2", "10"}), test = meta({"0"});

    // Cameras 1.3 above the floor, each turned by a right angle more than the one before, with −Y up.
    static json meta(const std::vector<std::string>& cameras) {
        json result = {{"w", 64}, {"h", 36}};
        for (const char* key : {"k", "w2c", "fn", "cam_id"}) result[key] = json::array();
        for (int frame = 0; frame < kFrames; ++frame) {
            json k, w2c, fn, id;
            for (const std::string& name : cameras) {
                const int number = std::stoi(name);
                const auto c = std::lround(std::cos(1.5707963 * number)), s = std::lround(std::sin(1.5707963 * number));
                k.push_back({{54, 0, 31.5}, {0, 55, 18.5}, {0, 0, 1}});
                w2c.push_back({{c, 0, -s, 0}, {0, 1, 0, 1.3}, {s, 0, c, 2.4}, {0, 0, 0, 1}});
                fn.push_back(fmt::format("{}/{:06}.jpg", name, frame));
                id.push_back(number);
            }
            result["k"].push_back(k);
            result["w2c"].push_back(w2c);
            result["fn"].push_back(fn);
            result["cam_id"].push_back(id);
        }
        return result;
    }
    Dynamic3dgs() {
        for (const char* name : {"0", "1", "2", "10"})
            for (int frame = 0; frame < kFrames; ++frame)
                test::write_grey_png(folder.path / "ims" / name / fmt::format("{:06}.jpg", frame), 64, 36);
    }
    // Masks whose left half is 0 and whose right half is 1.
    void put_masks() const {
        media::Image mask(64, 36);
        for (size_t i = 0; i < mask.rgba.size(); ++i) mask.rgba[i] = i % 4 == 3 ? 255 : i / 4 % 64 >= 32;
        for (const char* name : {"0", "1", "2", "10"}) {
            std::filesystem::create_directories(folder.path / "seg" / name);
            for (int frame = 0; frame < kFrames; ++frame)
                media::write_png(folder.path / "seg" / name / fmt::format("{:06}.png", frame), mask);
        }
    }
    training::Rig read(Split split = Split::kTrain, const std::string& holdout = "") const {
        write_text(folder.path / "train_meta.json", train.dump());
        if (!test.is_null()) write_text(folder.path / "test_meta.json", test.dump());
        return training::read_rig(folder.path, split, "auto", holdout);
    }
    static std::string names(const training::Rig& rig) {
        std::string text;
        for (const training::RigCamera& camera : rig.cameras) text += camera.name + " ";
        return text;
    }
    void expect_bad(const char* pointer, const json& value, std::initializer_list<std::string> words) {
        const json good = train;
        train[json::json_pointer(pointer)] = value;
        expect_input_error([&] { read(); }, words);
        train = good;
    }
};

TEST_F(Dynamic3dgs, APointFallsWhereItsProgramPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "dynamic3dgs");
    EXPECT_EQ(names(rig), "1 2 10 ");
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, 1.3, 1e-12) << "above the floor, +Y up";
    // A point at (0.4, −0.2, 2) in the camera 1, whose world_z is −x and whose x is −z of the world. The corner of the
    // image is at 0, so that a pixel's centre is at +½, as ours.
    const glm::dvec3 world(2 - 2.4, -0.2 - 1.3, -0.4);
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {world.x, -world.y, -world.z});
    EXPECT_NEAR(found.x, 54 * 0.2 + 31.5, 1e-9);
    EXPECT_NEAR(found.y, 55 * -0.1 + 18.5, 1e-9);
}

TEST_F(Dynamic3dgs, TestMetaHoldsCamerasOut) {
    EXPECT_EQ(names(read(Split::kTest)), "0 ");
    EXPECT_EQ(names(read(Split::kTrain, "2,")), "0 1 10 ");
    EXPECT_EQ(names(read(Split::kTest, "2,")), "2 ");
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 9u);
    EXPECT_EQ(rig.shots[1].time, 0.5);
    EXPECT_EQ(rig.shots[8].name, "10_000002");
    EXPECT_EQ(rig.shots[8].image.path, folder.path / "ims" / "10" / "000002.jpg");
    EXPECT_TRUE(rig.shots[8].mask.path.empty());
    test = nullptr;
    std::filesystem::remove(folder.path / "test_meta.json");
    EXPECT_EQ(names(read(Split::kTest)), "1 ") << "every 8th of those that there are";
    EXPECT_EQ(names(read(Split::kTrain)), "2 10 ");
}

TEST_F(Dynamic3dgs, OneInAMaskIsThePerformer) {
    put_masks();
    const training::Rig rig = read();
    EXPECT_EQ(rig.shots[4].mask.path, folder.path / "seg" / "2" / "000001.png");
    const training::Dataset dataset = training::load_dataset(folder.path, Split::kTrain);
    EXPECT_EQ(dataset.views[0].image.at(20, 20)[3], 0);
    EXPECT_EQ(dataset.views[0].image.at(50, 20)[3], 255);
    std::filesystem::remove(folder.path / "seg" / "2" / "000001.png");
    expect_input_error([&] { read(); }, {"train_meta.json", "fn[1][1]", "no mask", "000001.png"});
}

TEST_F(Dynamic3dgs, MissingImagesAreLeftOut) {
    std::filesystem::remove(folder.path / "ims" / "2" / "000001.jpg");
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 8u);
    EXPECT_EQ(rig.shots[4].time, 1);
    EXPECT_EQ(rig.remarks,
              (std::vector<std::string>{"1 of 12 images are not there, and are left out: ims/2/000001.jpg"}));
    std::filesystem::remove_all(folder.path / "ims" / "2");
    EXPECT_EQ(names(read()), "1 10 ");
    for (const char* name : {"1", "10"}) std::filesystem::remove_all(folder.path / "ims" / name);
    expect_input_error([&] { read(); }, {"train_meta.json", "fn[0][0]", "9 of 12 images"});
}

TEST_F(Dynamic3dgs, DamageIsNamed) {
    expect_bad("/k/0/1", {{54, 0, 31}, {0, 54, 18}}, {"train_meta.json", "k[0][1]", "9 numbers"});
    expect_bad("/k/1/1", {{50, 0, 31}, {0, 54, 18}, {0, 0, 1}}, {"k[1][1]", "stand still"});
    expect_bad("/k/1", json::array(), {"k[1]"});
    expect_bad("/k", 3, {"k", "array"});
    expect_bad("/w2c/0/0/0/0", 2, {"w2c[0][0]"});
    expect_bad("/w2c/2/0/1/3", 1.4, {"w2c[2][0]", "stand still"});
    expect_bad("/w2c/2", json(), {"w2c[2]"});
    expect_bad("/fn/0/0", "../000000.jpg", {"fn[0][0]", "folder"});
    expect_bad("/fn/0/0", "000000.jpg", {"fn[0][0]", "CAMERA/FRAME"});
    expect_bad("/fn/0/0", "0/000000.jpg", {"test_meta.json", "fn[0][0]", "train_meta.json", "apart"});
    expect_bad("/fn/1/0", "1/000000.jpg", {"fn[1][0]", "second image"});
    expect_bad("/fn", json::array(), {"fn"});
    expect_bad("/w", 32, {"64×36", "32×36", "another shape"});
    expect_bad("/w", -1, {"w"});
    train = json::array();
    expect_input_error([&] { read(); }, {"train_meta.json"});
}

}  // namespace
}  // namespace neuvv
