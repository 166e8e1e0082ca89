// The layout of EasyMocap, in which ZJU-MoCap can be given, too.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <tuple>

#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using test::yaml_matrix;

struct EasyMocapTest : testing::Test {
    TemporaryFolder folder;
    std::vector<std::string> names = {"01", "02", "10"};
    std::string intrinsics, extrinsics;

    // Camera i stands at (0, 0, −4 − i), turned by 0.1 i about x.
    static glm::dvec3 axis_angle(size_t i) { return {0.1 * static_cast<double>(i), 0, 0}; }
    static glm::dvec3 translation(size_t i) { return {0.25, -0.5, 4.0 + static_cast<double>(i)}; }

    EasyMocapTest() {
        intrinsics = extrinsics = test::yaml_names(names);
        for (size_t i = 0; i < names.size(); ++i) {
            intrinsics += yaml_matrix("K_" + names[i], 3, 3, {90, 0, 31, 0, 95, 22, 0, 0, 1});
            intrinsics += yaml_matrix("dist_" + names[i], 1, 5, {0.1, -0.05, 0.01, 0.02, 0.03});
            intrinsics += fmt::format("H_{0}: 48\r\nW_{0}: 64\r\n", names[i]);
            const glm::dvec3 r = axis_angle(i), t = translation(i);
            extrinsics += yaml_matrix("R_" + names[i], 3, 1, {r.x, r.y, r.z});
            const double c = std::cos(r.x), s = std::sin(r.x);
            extrinsics += yaml_matrix("Rot_" + names[i], 3, 3, {1, 0, 0, 0, c, -s, 0, s, c});
            extrinsics += yaml_matrix("T_" + names[i], 3, 1, {t.x, t.y, t.z});
            for (int frame = 0; frame < 3; ++frame)
                test::write_grey_png(folder.path / "images" / names[i] / fmt::format("{:06}.png", frame), 64, 48);
        }
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "intri.yml", intrinsics);
        write_text(folder.path / "extri.yml", extrinsics);
        return training::read_rig(folder.path, split);
    }
    // Replaces the first `from` in a file by `to` and expects an error that mentions `parts`.
    void expect_bad(std::string EasyMocapTest::*file, const std::string& from, const std::string& to,
                    std::initializer_list<std::string> parts) {
        const std::string good = this->*file;
        const size_t at = good.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        (this->*file).replace(at, from.size(), to);
        expect_input_error([&] { read(); }, parts);
        this->*file = good;
    }
};

TEST_F(EasyMocapTest, APointFallsWhereOpenCvPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "easymocap");
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[1].name, "10");
    const glm::dvec3 in_camera(0.9, -0.6, 3);
    const double angle = axis_angle(2).x, x = 0.3, y = -0.2, r2 = x * x + y * y;
    const glm::dvec3 world =
        glm::angleAxis(-angle, glm::dvec3(1, 0, 0)) * (in_camera - translation(2));  // x_cam = R x_world + T
    const double radial = 1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2;
    const double u = 90 * (radial * x + 2 * 0.01 * x * y + 0.02 * (r2 + 2 * x * x)) + 31;
    const double v = 95 * (radial * y + 2 * 0.02 * x * y + 0.01 * (r2 + 2 * y * y)) + 22;
    const glm::dvec2 found = test::pixel_of(rig.cameras[1], world);
    EXPECT_NEAR(found.x, u + 0.5, 1e-7) << "OpenCV's first pixel has its centre at 0, ours at ½";
    EXPECT_NEAR(found.y, v + 0.5, 1e-7);
    EXPECT_EQ(rig.cameras[1].lens.width, 64u);
    EXPECT_EQ(rig.cameras[1].lens.height, 48u);
}

TEST_F(EasyMocapTest, AMatrixServesAsRotationToo) {
    const training::Rig from_vector = read();
    for (size_t at = 0; (at = extrinsics.find("R_", at)) != std::string::npos;) extrinsics.replace(at, 2, "V_");
    const training::Rig from_matrix = read();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            EXPECT_NEAR(from_matrix.cameras[1].world_from_camera[column][row],
                        from_vector.cameras[1].world_from_camera[column][row], 1e-8);
}

TEST_F(EasyMocapTest, FramesMeetByName) {
    std::filesystem::remove(folder.path / "images" / "02" / "000001.png");
    for (const std::string& name : names)
        for (int frame = 0; frame < 3; ++frame)
            test::write_grey_png(folder.path / "mask" / name / fmt::format("{:06}.png", frame), 64, 48, 255);
    const training::Rig train = read(), held_out = read(training::Split::kTest);
    ASSERT_EQ(held_out.cameras.size(), 1u);
    EXPECT_EQ(held_out.cameras[0].name, "01");
    EXPECT_EQ(held_out.shots.size(), 3u);
    ASSERT_EQ(train.shots.size(), 5u);
    EXPECT_EQ(train.shots[0].time, 0);
    EXPECT_EQ(train.shots[1].time, 1);
    EXPECT_EQ(train.shots[3].time, 0.5);
    EXPECT_EQ(train.shots[3].name, "10_000001");
    EXPECT_EQ(train.shots[3].mask.path, folder.path / "mask" / "10" / "000001.png");
}

// Masks of ZJU-MoCap have numbers of body parts, or 0 and 1; other masks have white.
TEST_F(EasyMocapTest, MasksOfSmallNumbersAreLabels) {
    for (const std::string key : {"D_", "dist_"})  // no distortion: every pixel stays where it is
        for (size_t at = 0; (at = intrinsics.find(key, at)) != std::string::npos;)
            intrinsics.replace(at, key.size(), "x_");
    for (const auto& [masks, value, meaning] : {std::tuple("mask_cihp", 200, training::MaskMeaning::kLabels),
                                                std::tuple("mask", 1, training::MaskMeaning::kLabels),
                                                std::tuple("masks", 200, training::MaskMeaning::kMatte)}) {
        media::Image mask(64, 48);
        for (size_t i = 0; i < mask.rgba.size(); ++i)
            mask.rgba[i] = static_cast<uint8_t>(i % 4 == 3 ? 255 : i / 4 % 64 >= 32 ? value : 0);
        for (const std::string& name : names)
            for (int frame = 0; frame < 3; ++frame) {
                std::filesystem::create_directories(folder.path / masks / name);
                media::write_png(folder.path / masks / name / fmt::format("{:06}.png", frame), mask);
            }
        EXPECT_EQ(read().masks, meaning) << masks;
        const training::Dataset dataset = training::load_dataset(folder.path, training::Split::kTrain);
        EXPECT_EQ(dataset.views[0].image.at(20, 20)[3], 0) << masks;
        EXPECT_EQ(dataset.views[0].image.at(50, 20)[3], meaning == training::MaskMeaning::kLabels ? 255 : value)
            << masks;
    }
}

// EasyVolcap's captures: what it has made of a calibration lies in optimized/, and masks in folders by their program.
TEST_F(EasyMocapTest, EasyVolcapsCalibrationAndMasksAreRead) {
    const double before = read().cameras[1].world_from_camera[3].z;
    write_text(folder.path / "optimized" / "intri.yml", intrinsics);
    std::string moved = extrinsics;
    const size_t at = moved.find("T_10"), number = moved.find("6.0", at);
    ASSERT_LT(number, moved.size());
    moved.replace(number, 3, "6.5");
    write_text(folder.path / "optimized" / "extri.yml", moved);
    for (const char* masks : {"msk", "bgmtv2"}) {
        for (const std::string& name : names)
            for (int frame = 0; frame < 3; ++frame)
                test::write_grey_png(folder.path / masks / name / fmt::format("{:06}.png", frame), 64, 48, 255);
        const training::Rig rig = read();
        EXPECT_EQ(rig.file, (folder.path / "optimized" / "intri.yml").string());
        EXPECT_GT(std::abs(rig.cameras[1].world_from_camera[3].z - before), 0.4);
        EXPECT_EQ(rig.shots[3].mask.path, folder.path / masks / "10" / "000000.png");
        ASSERT_GE(rig.remarks.size(), 2u);
        EXPECT_EQ(rig.remarks[rig.remarks.size() - 1], "optimized/extri.yml was read, not extri.yml");
    }
    EXPECT_EQ(read().remarks[0], "bgmtv2/ was read, not msk/");
    std::filesystem::remove(folder.path / "intri.yml");
    EXPECT_EQ(training::read_rig(folder.path, training::Split::kTrain).cameras.size(), 2u) << "optimized/ alone";
    std::filesystem::remove(folder.path / "optimized" / "extri.yml");
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); }, {"optimized/extri.yml"});
}

TEST_F(EasyMocapTest, CamerasWithoutImagesAreLeftOut) {
    std::filesystem::remove_all(folder.path / "images" / "02");
    EXPECT_EQ(read().cameras.size(), 1u);
    std::filesystem::remove_all(folder.path / "images" / "10");
    expect_input_error([&] { read(); }, {"intri.yml", "one camera"});
    std::filesystem::remove_all(folder.path / "images" / "01");
    expect_input_error([&] { read(); }, {"no image", "images/<camera>"});
}

TEST_F(EasyMocapTest, FramesOfForeignNamesAreRefused) {
    for (const std::string& name : names) {
        std::filesystem::remove_all(folder.path / "images" / name);
        test::write_grey_png(folder.path / "images" / name / ("clip_" + name + "_0.png"), 64, 48);
    }
    expect_input_error([&] { read(); }, {"no image of one camera is named as one of another"});
}

TEST_F(EasyMocapTest, DamageIsNamed) {
    constexpr auto in = &EasyMocapTest::intrinsics, ex = &EasyMocapTest::extrinsics;
    expect_bad(in, "names:", "nomes:", {"intri.yml", "names", "missing"});
    expect_bad(in, "- \"02\"", "- \"../02\"", {"intri.yml", "names", "folder"});
    expect_bad(in, "- \"02\"", "- \"01\"", {"intri.yml", "names", "twice"});
    expect_bad(in, "- \"02\"", "- [a]", {"intri.yml", "names", "line"});
    expect_bad(in, "K_02", "Q_02", {"intri.yml", "K_02", "missing"});
    expect_bad(in, "rows: 3", "rows: 4", {"intri.yml", "K_01", "line", "9 numbers"});
    expect_bad(in, "rows: 3", "rows: 4000000000", {"intri.yml", "K_01"});
    expect_bad(in, "90.0", ".nan", {"intri.yml", "K_01", "number"});
    expect_bad(in, "90.0", "ninety", {"intri.yml", "K_01", "number"});
    expect_bad(in, "90.0000000000, 0.0", "90.0000000000, 5.0", {"intri.yml", "K_01", "skew"});
    expect_bad(in, "90.0000000000", "-90.0000000000", {"intri.yml", "K_01", "focal"});
    expect_bad(in, "H_01: 48", "H_01: 48.5", {"intri.yml", "H_01", "48.5"});
    expect_bad(in, "H_01: 48", "H_01: 0", {"intri.yml", "K_01", "64×0"});
    expect_bad(in, "data: [", "data: [[", {"intri.yml", "line"});
    expect_bad(ex, "T_02", "S_02", {"extri.yml", "T_02", "missing"});
    expect_bad(ex, "4.0000000000", "4e9", {"origin"});
    for (size_t at = 0; (at = extrinsics.find("R_", at)) != std::string::npos;) extrinsics.replace(at, 2, "V_");
    expect_bad(ex, "Rot_02", "Ret_02", {"extri.yml", "R_02", "missing"});
    expect_bad(ex, "[1.0", "[-1.0", {"extri.yml", "Rot_01", "no rotation"});
    expect_bad(ex, "[1.0", "[1.5", {"extri.yml", "Rot_01", "no rotation"});
    read();
    std::filesystem::remove(folder.path / "extri.yml");
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); }, {"extri.yml"});
}

TEST_F(EasyMocapTest, TruncatedAnywhereIsNeverSilent) {
    const std::string whole = intrinsics;  // distortion and size are optional
    for (size_t length = 0; length < whole.find("dist_10"); length += 7) {
        intrinsics = whole.substr(0, length);
        try {
            read();
            ADD_FAILURE() << "read the first " << length << " bytes";
        } catch (const InputError&) {
        }
    }
}

// The published data set has a pickle, which could run any code.
TEST_F(EasyMocapTest, PicklesAreRefusedWithTheMend) {
    const TemporaryFolder zju;
    write_text(zju.path / "annots.npy", "\x93NUMPY");
    expect_input_error([&] { training::read_rig(zju.path, training::Split::kTrain); },
                       {"annots.npy", "pickle", "intri.yml", "zju_mocap.py"});
}

}  // namespace
}  // namespace neuvv
