// Raw data of the app Polycam.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using nlohmann::json;

struct Polycam : testing::Test {
    TemporaryFolder folder;
    // The camera's x is the world's −Z, its y is up, and it looks along −X, from (1, 2, 3).
    json camera = {{"fx", 90},     {"fy", 95},  {"cx", 31.5}, {"cy", 22.5},     {"width", 64},
                   {"height", 48}, {"t_00", 0}, {"t_01", 0},  {"t_02", 1},      {"t_03", 1},
                   {"t_10", 0},    {"t_11", 1}, {"t_12", 0},  {"t_13", 2},      {"t_20", -1},
                   {"t_21", 0},    {"t_22", 0}, {"t_23", 3},  {"timestamp", 7}, {"blur_score", 80.0}};

    void write(const char* cameras, const char* images) const {
        for (const char* name : {"100", "200", "300"}) {
            write_text(folder.path / "keyframes" / cameras / (std::string(name) + ".json"), camera.dump());
            test::write_grey_png(folder.path / "keyframes" / images / (std::string(name) + ".png"), 64, 48);
        }
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const char* key, const json& value, std::initializer_list<std::string> words) {
        const json good = camera;
        camera[key] = value;
        write("cameras", "images");
        expect_input_error([&] { read(); }, words);
        camera = good;
    }
};

TEST_F(Polycam, APointFallsWhereItShould) {
    write("cameras", "images");
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "polycam");
    ASSERT_EQ(rig.cameras.size(), 2u);
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {1 - 2, 2 + 0.5, 3 - 0.4});
    EXPECT_NEAR(found.x, 31.5 + 90 * 0.4 / 2, 1e-9);
    EXPECT_NEAR(found.y, 22.5 - 95 * 0.5 / 2, 1e-9);
    EXPECT_EQ(rig.shots[0].time, rig.shots[1].time) << "all images show one frame";
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_NE(rig.remarks[0].find("several cameras"), std::string::npos);
}

TEST_F(Polycam, CorrectedCamerasComeFirst) {
    write("cameras", "images");
    camera["fx"] = 80;
    write("corrected_cameras", "corrected_images");
    const training::Rig rig = read();
    EXPECT_EQ(rig.cameras[0].lens.fx, 80);
    EXPECT_EQ(rig.shots[0].image.path.parent_path().filename(), "corrected_images");
}

TEST_F(Polycam, DamageIsNamed) {
    expect_bad("fx", -1, {"100.json", "fx", "focal"});
    expect_bad("fx", "wide", {"100.json", "fx", "string"});
    expect_bad("t_22", 0.5, {"100.json"});
    expect_bad("width", 60, {"100.png", "64×48", "60×48"});
    expect_bad("height", 1e9, {"100.json", "height"});
    write("cameras", "images");
    std::filesystem::remove(folder.path / "keyframes" / "cameras" / "200.json");
    expect_input_error([&] { read(); }, {"200.json"});
    std::filesystem::remove_all(folder.path / "keyframes" / "images");
    expect_input_error([&] { read(); }, {"keyframes/images", "Raw Data"});
}

}  // namespace
}  // namespace neuvv
