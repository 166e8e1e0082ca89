// Data sets written for other programs, read back.
#include "training/data/write_dataset.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"
#include "training/data/reduce.h"

namespace neuvv {
namespace {

using training::Split;

struct WriteDataset : testing::Test {
    TemporaryFolder folder;
    std::vector<std::string> names = {"cam01", "cam02", "cam03"};

    std::filesystem::path from() const { return folder.path / "from"; }
    std::filesystem::path to() const { return folder.path / "to"; }

    // An image with a performer whose edge is soft, over a background.
    static media::Image picture(size_t camera, int frame, bool matte) {
        media::Image image(64, 48);
        for (uint32_t y = 0; y < 48; ++y)
            for (uint32_t x = 0; x < 64; ++x) {
                const auto edge = static_cast<int>(x) - 20 - 2 * frame;
                uint8_t* pixel = image.at(x, y);
                pixel[0] = static_cast<uint8_t>(30 + 3 * x);
                pixel[1] = static_cast<uint8_t>(20 + 4 * y);
                pixel[2] = static_cast<uint8_t>(90 + 20 * camera + 5 * static_cast<size_t>(frame));
                if (matte) std::fill_n(pixel, 3, static_cast<uint8_t>(std::clamp(64 * edge, 0, 255)));
                pixel[3] = 255;
            }
        return image;
    }
    // EasyMocap's layout far from the origin, with masks; the lens of the second camera distorts.
    void write_capture(bool plates, bool masks = true) const {
        std::string intrinsics = test::yaml_names(names), extrinsics = intrinsics;
        for (size_t i = 0; i < names.size(); ++i) {
            const double shift = static_cast<double>(i);
            intrinsics += test::yaml_matrix("K_" + names[i], 3, 3, {60 + shift, 0, 31, 0, 62, 22, 0, 0, 1});
            if (i == 1) intrinsics += test::yaml_matrix("D_" + names[i], 1, 5, {0.2, 0.05, 0.002, -0.003, 0});
            extrinsics += test::yaml_matrix("R_" + names[i], 3, 1, {0.1, 0.2, 0});
            extrinsics += test::yaml_matrix("T_" + names[i], 3, 1, {5000 + shift, 2, 4 + shift});
            for (int frame = 0; frame < 3; ++frame)
                for (const auto& [parent, matte] : {std::pair("images", false), std::pair("masks", true)}) {
                    if (matte && !masks) continue;
                    std::filesystem::create_directories(from() / parent / names[i]);
                    media::write_png(from() / parent / names[i] / fmt::format("{:04}.png", frame),
                                     picture(i, frame, matte));
                }
            if (!plates) continue;
            std::filesystem::create_directories(from() / "plates");
            media::write_png(from() / "plates" / (names[i] + ".png"), picture(i, 0, false));
        }
        write_text(from() / "intri.yml", intrinsics);
        write_text(from() / "extri.yml", extrinsics);
    }
    training::WriteSummary write(const std::string& holdout = "") const {
        return training::write_dataset(training::read_both_splits(from(), "auto", holdout), to(), {});
    }
    static void expect_same(const training::Dataset& a, const training::Dataset& b) {
        ASSERT_EQ(a.cameras.size(), b.cameras.size());
        ASSERT_EQ(a.views.size(), b.views.size());
        EXPECT_EQ(a.frame, b.frame);
        EXPECT_EQ(a.camera_names, b.camera_names);
        EXPECT_EQ(a.times, b.times);
        for (size_t c = 0; c < a.cameras.size(); ++c) {
            const stage::Camera &x = a.cameras[c], &y = b.cameras[c];
            EXPECT_EQ(std::tuple(x.fx, x.fy, x.cx, x.cy, x.width, x.height),
                      std::tuple(y.fx, y.fy, y.cx, y.cy, y.width, y.height));
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    EXPECT_NEAR(x.world_from_camera[column][row], y.world_from_camera[column][row], 1e-9);
            EXPECT_EQ(a.plates[c].rgba, b.plates[c].rgba);
        }
        for (size_t v = 0; v < a.views.size(); ++v) {
            EXPECT_EQ(a.views[v].name, b.views[v].name);
            EXPECT_EQ(a.views[v].time, b.views[v].time);
            expect_same_pixels(a.views[v], b.views[v]);
        }
    }
    // Where alpha is 0, RGB means nothing.
    static void expect_same_pixels(const training::View& a, const training::View& b) {
        size_t different = 0, seen = 0;
        for (uint32_t y = 0; y < a.image.height(); ++y)
            for (uint32_t x = 0; x < a.image.width(); ++x) {
                const uint8_t *one = a.image.at(x, y), *other = b.image.at(x, y);
                different += a.ignores(x, y) != b.ignores(x, y) || one[3] != other[3] ||
                             (one[3] > 0 && !std::equal(one, one + 3, other));
                seen += one[3] > 0;
            }
        EXPECT_EQ(different, 0u) << a.name;
        EXPECT_GT(seen, 100u) << a.name;
    }
};

TEST_F(WriteDataset, WhatIsReadBackIsWhatWasRead) {
    for (const bool plates : {false, true}) {
        write_capture(plates);
        std::filesystem::remove_all(to());
        const training::WriteSummary wrote = write();
        EXPECT_TRUE(wrote.complete && wrote.mattes && wrote.masks);
        EXPECT_EQ(wrote.images, 9u);
        EXPECT_EQ(wrote.train_cameras, 2u);
        EXPECT_EQ(wrote.test_cameras, 1u);
        EXPECT_EQ(wrote.plates, plates ? 3u : 0u);
        EXPECT_EQ(std::filesystem::exists(to() / "plates"), plates);
        for (const Split split : {Split::kTrain, Split::kTest}) {
            const training::Dataset before = training::load_dataset(from(), split),
                                    after = training::load_dataset(to(), split);
            EXPECT_EQ(after.format, "nerf");
            expect_same(before, after);
            EXPECT_FALSE(before.frame.is_same()) << "5 km from the origin";
            EXPECT_EQ(training::read_rig(to(), split).masks, training::MaskMeaning::kUsable);
        }
        const training::Rig rig = training::read_rig(to(), Split::kTrain);
        EXPECT_TRUE(std::ranges::none_of(rig.cameras, [](const auto& camera) { return camera.lens.distorts(); }));
        EXPECT_TRUE(std::ranges::none_of(rig.remarks, [](const std::string& remark) {
            return remark.find("plates") != std::string::npos;
        })) << "the plate that the file names is that of plates/";
    }
}

// Other programs train the whole scene.
TEST_F(WriteDataset, WhatTheCameraSawStaysBehindThePerformer) {
    write_capture(false);
    write();
    const media::Image pinhole = media::read_png(to() / "images" / "cam03_0000.png"),
                       distorting = media::read_png(to() / "images" / "cam02_0000.png"),
                       matte = media::read_png(to() / "mattes" / "cam02_0000.png"),
                       mask = media::read_png(to() / "masks" / "cam02_0000.png");
    EXPECT_EQ(pinhole.at(5, 10)[3], 0);
    EXPECT_EQ(pinhole.at(5, 10)[0], 45);
    EXPECT_EQ(distorting.at(10, 24)[3], 0);
    EXPECT_NEAR(distorting.at(10, 24)[0], 60, 12) << "the lens moves it a little";
    EXPECT_EQ(matte.at(10, 24)[0], 0);
    EXPECT_EQ(matte.at(40, 24)[0], 255);
    EXPECT_EQ(mask.at(32, 24)[0], 255);
    EXPECT_EQ(mask.at(0, 0)[0], 0) << "the lens never saw the corner";
}

TEST_F(WriteDataset, WithoutMattesImagesAreOpaque) {
    write_capture(false, false);
    const training::WriteSummary wrote = write("0");
    EXPECT_FALSE(wrote.mattes);
    EXPECT_EQ(wrote.test_cameras, 0u);
    EXPECT_FALSE(wrote.missing_split.empty());
    EXPECT_FALSE(std::filesystem::exists(to() / "mattes"));
    EXPECT_FALSE(std::filesystem::exists(to() / "transforms_test.json"));
    EXPECT_EQ(media::read_png(to() / "images" / "cam01_0000.png").at(5, 5)[3], 255);
    EXPECT_EQ(training::load_dataset(to(), Split::kTrain, {.mattes_needed = false}).views.size(), 9u);
}

TEST_F(WriteDataset, TheFileSaysWhatOtherProgramsNeed) {
    write_capture(true);
    write();
    const auto file = nlohmann::json::parse(read_text(to() / "transforms_train.json"));
    EXPECT_EQ(file["written_by"], "neuvv dataset");
    ASSERT_EQ(file["frames"].size(), 6u);
    const auto& frame = file["frames"][0];
    EXPECT_EQ(frame["file_path"], "images/cam02_0000.png");
    EXPECT_EQ(frame["mask_path"], "masks/cam02_0000.png");
    EXPECT_EQ(frame["background_path"], "plates/cam02.png");
    EXPECT_EQ(frame["w"], 64);
    EXPECT_NEAR(frame["fl_x"].get<double>(), 61, 1e-9) << "each camera has its own";
    EXPECT_NEAR(frame["cx"].get<double>(), 31.5, 1e-9);
    EXPECT_GT(std::abs(frame["transform_matrix"][0][3].get<double>()), 4000) << "in the capture's coordinates";
}

TEST_F(WriteDataset, CamerasKeepTheirNames) {
    nlohmann::json document = {{"fl_x", 60}};
    for (int camera = 1; camera <= 3; ++camera)
        for (int frame = 0; frame < 2; ++frame) {
            const std::string path = fmt::format("images/{:02}/{:04}.png", camera, frame);
            test::write_grey_png(from() / path, 64, 48);
            document["frames"].push_back(
                {{"file_path", path},
                 {"transform_matrix", {{1, 0, 0, camera}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}}});
        }
    write_text(from() / "transforms.json", document.dump());
    write();
    for (const Split split : {Split::kTrain, Split::kTest}) {
        const training::Rig before = training::read_rig(from(), split), after = training::read_rig(to(), split);
        ASSERT_EQ(before.cameras.size(), after.cameras.size());
        for (size_t c = 0; c < before.cameras.size(); ++c) EXPECT_EQ(before.cameras[c].name, after.cameras[c].name);
        EXPECT_EQ(before.shots[0].name, "images_" + after.shots[0].name);
    }
}

// Images of the validation are often those of the test.
TEST_F(WriteDataset, TheValidationGoesAlong) {
    const auto put = [&](const char* split, const std::vector<int>& cameras) {
        nlohmann::json document = {{"fl_x", 60}};
        for (const int camera : cameras) {
            const std::string path = fmt::format("images/cam{}_0.png", camera);
            test::write_grey_png(from() / path, 64, 48, static_cast<uint8_t>(20 * camera));
            document["frames"].push_back(
                {{"file_path", path},
                 {"transform_matrix", {{1, 0, 0, camera}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}}});
        }
        write_text(from() / fmt::format("transforms_{}.json", split), document.dump());
    };
    put("train", {1, 2});
    put("test", {3});
    const auto again = [&] {
        training::BothSplits splits = training::read_both_splits(from(), "auto");
        training::add_validation(splits, from(), "auto");
        std::filesystem::remove_all(to());
        return training::write_dataset(splits, to(), {});
    };
    EXPECT_EQ(again().val_cameras, 0u);
    EXPECT_FALSE(std::filesystem::exists(to() / "transforms_val.json"));
    put("val", {3, 4});
    const training::WriteSummary wrote = again();
    EXPECT_EQ(wrote.images, 4u) << "that of camera 3 counts once";
    EXPECT_EQ(wrote.val_cameras, 2u);
    for (const Split split : {Split::kTrain, Split::kTest, Split::kVal}) {
        const training::LoadOptions any{.mattes_needed = false};
        expect_same(training::load_dataset(from(), split, any), training::load_dataset(to(), split, any));
    }
}

TEST_F(WriteDataset, EachCameraHasAPlateOfItsOwn) {
    nlohmann::json document = {{"fl_x", 60}};
    const std::vector<std::string> cameras = {"left/top", "left_top", "right"};
    for (size_t c = 0; c < cameras.size(); ++c) {
        const std::string image = fmt::format("{}/{}.png", cameras[c], c), plate = fmt::format("bare{}.png", c);
        test::write_grey_png(from() / image, 64, 48);
        test::write_grey_png(from() / plate, 64, 48, static_cast<uint8_t>(10 * (c + 1)));
        document["frames"].push_back({{"file_path", image},
                                      {"background_path", plate},
                                      {"transform_matrix", {{1, 0, 0, c}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}}});
    }
    write_text(from() / "transforms.json", document.dump());
    write("0");
    const training::Dataset read = training::load_dataset(to(), Split::kTrain, {.mattes_needed = false});
    ASSERT_EQ(read.plates.size(), 3u);
    for (size_t c = 0; c < 3; ++c) EXPECT_EQ(read.plates[c].at(5, 5)[0], 10 * (c + 1)) << read.camera_names[c];
}

TEST_F(WriteDataset, ItStopsWhereTheCallerSays) {
    write_capture(false);
    const training::WriteSummary wrote =
        training::write_dataset(training::read_both_splits(from(), "auto"), to(),
                                [](uint64_t done, uint64_t total) { return done < 2 && total == 9; });
    EXPECT_FALSE(wrote.complete);
    EXPECT_FALSE(std::filesystem::exists(to() / "transforms_train.json"));
}

TEST_F(WriteDataset, APartOfTheClipIsAClip) {
    write_capture(false);
    training::BothSplits both = training::read_both_splits(from(), "auto", "");
    EXPECT_EQ(training::frame_count(both), 3u);
    training::keep_frames(both, 1, 2);
    EXPECT_EQ(training::write_dataset(both, to(), {}).images, 6u);
    const training::Rig after = training::read_rig(to(), Split::kTrain);
    ASSERT_EQ(after.shots.size(), 4u);
    EXPECT_EQ(after.shots[0].name, "cam02_0001");
    EXPECT_EQ(after.shots[0].time, 0);
    EXPECT_EQ(after.shots[1].name, "cam02_0002");
    EXPECT_EQ(after.shots[1].time, 1);
    training::keep_frames(both, 1, 1);
    EXPECT_EQ(both.rigs[0].shots.size(), 2u);
    EXPECT_EQ(both.rigs[0].shots[0].name, "cam02_0002");
    EXPECT_EQ(both.rigs[0].shots[0].time, 0);

    std::erase_if(both.rigs[1].shots, [](const training::Shot&) { return true; });
    expect_input_error([&] { training::keep_frames(both, 0, 0); }, {"intri.yml", "no image of the frames 0 to 0"});
}

TEST_F(WriteDataset, ReducedImagesShowTheSame) {
    write_capture(true);
    training::write_dataset(training::read_both_splits(from(), "auto", ""), to(), {}, 3);
    const training::Dataset before = training::load_dataset(from(), Split::kTest),
                            after = training::load_dataset(to(), Split::kTest);
    const stage::Camera &large = before.cameras[0], &small = after.cameras[0];
    EXPECT_EQ(std::tuple(small.width, small.height), std::tuple(21u, 16u)) << "a column of 64 is left over";
    EXPECT_NEAR(small.fx, large.fx / 3, 1e-9);
    EXPECT_NEAR(small.cx, large.cx / 3, 1e-9);
    EXPECT_NEAR(small.cy, large.cy / 3, 1e-9);
    const media::Image from_image = before.views[0].image.whole(), to_image = after.views[0].image.whole();
    double matte = 0, colour = 0;
    for (uint32_t v = 0; v < 3; ++v)
        for (uint32_t u = 0; u < 3; ++u) {
            matte += from_image.at(30 + u, 21 + v)[3] / 9.0;
            colour += from_image.at(30 + u, 21 + v)[1] / 9.0;
        }
    EXPECT_NEAR(to_image.at(10, 7)[3], matte, 0.5);
    EXPECT_NEAR(to_image.at(10, 7)[1], colour, 0.5);
    EXPECT_EQ(media::read_png(to() / "plates" / "cam02.png").width, 21u);
    expect_input_error([&] { training::write_dataset(training::read_both_splits(from(), "auto", ""), to(), {}, 49); },
                       {"intri.yml", "64×48", "too small to be reduced 49 times"});
}

TEST(Reduced, ColoursAreWeightedByAlpha) {
    media::Image image(5, 2);
    const auto set = [&](uint32_t x, uint32_t y, uint8_t grey, uint8_t alpha) {
        std::fill_n(image.at(x, y), 3, grey);
        image.at(x, y)[3] = alpha;
    };
    set(0, 0, 200, 255);
    set(1, 0, 100, 51);
    set(2, 0, 40, 0);
    set(3, 1, 81, 0);
    set(4, 0, 255, 255);
    const media::Image half = training::reduced(image, 2);
    ASSERT_EQ(half.width, 2u);
    ASSERT_EQ(half.height, 1u);
    EXPECT_EQ(half.at(0, 0)[0], 183) << "(200 · 5 + 100) / 6";
    EXPECT_EQ(half.at(0, 0)[3], 77) << "306 / 4";
    EXPECT_EQ(half.at(1, 0)[1], 30) << "121 / 4, where nothing has alpha";
    EXPECT_EQ(half.at(1, 0)[3], 0);
    EXPECT_EQ(training::reduced(image, 1).rgba, image.rgba);
    std::vector<bool> ignored(10);
    ignored[7] = ignored[4] = true;
    EXPECT_EQ(training::reduced(ignored, {5, 2}, 2), (std::vector<bool>{false, true}));
}

}  // namespace
}  // namespace neuvv
