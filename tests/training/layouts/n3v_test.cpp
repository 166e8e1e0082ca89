// poses_bounds.npy with videos, as in Neural 3D Video; and the .npy format.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/formats/npy.h"
#include "media/video.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

std::string npy_header(int version, std::string dictionary) {
    const size_t begin = version == 1 ? 10 : 12;
    while ((begin + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
    dictionary += '\n';
    std::string head = "\x93NUMPY";
    head += static_cast<char>(version);
    head += '\0';
    for (size_t i = 0; i < begin - 8; ++i) head += static_cast<char>(dictionary.size() >> 8 * i & 255);
    return head + dictionary;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

NpyArray parse(const std::string& file) {
    return parse_npy({file.begin(), file.end()}, "a.npy", "header");
}

const char kTwoByThree[] = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";

TEST(Npy, AllVersionsAndBothWidths) {
    for (const int version : {1, 2, 3}) {
        const NpyArray array = parse(npy_header(version, kTwoByThree) + bytes_of<double>({1, 2, 3, 4, 5, -6.5}));
        EXPECT_EQ(array.shape, (std::vector<uint64_t>{2, 3}));
        EXPECT_EQ(array.values, (std::vector<double>{1, 2, 3, 4, 5, -6.5}));
    }
    const NpyArray single =
        parse(npy_header(1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }") + bytes_of<float>({0.5f, 3}));
    EXPECT_EQ(single.values, (std::vector<double>{0.5, 3}));
    EXPECT_EQ(
        parse(npy_header(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (), }") + bytes_of<double>({7})).values,
        (std::vector<double>{7}));
}

TEST(Npy, OthersAreRefusedByName) {
    const std::string data = bytes_of<double>({1, 2, 3, 4, 5, 6});
    const auto expect_bad = [&](const std::string& dictionary, std::initializer_list<std::string> parts) {
        expect_input_error([&] { parse(npy_header(1, dictionary) + data); }, parts);
    };
    expect_bad("{'descr': '>f8', 'fortran_order': False, 'shape': (2, 3), }", {"a.npy", ">f8", "little-endian"});
    expect_bad("{'descr': '|O', 'fortran_order': False, 'shape': (2, 3), }", {"|O"});
    expect_bad("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2, 3), }", {"records"});
    expect_bad("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", {"C order"});
    expect_bad("{'descr': '<f8', 'fortran_order': False, }", {"no shape"});
    expect_bad("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 4), }", {"48 bytes", "64"});
    expect_bad("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }", {"48 bytes", "32"});
    expect_bad("{'descr': '<f8', 'fortran_order': False, 'shape': (999999999, 999999999, 999999999), }", {"larger"});
    expect_bad("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 0), }", {"proportion"});
    expect_input_error([&] { parse(npy_header(4, kTwoByThree) + data); }, {"version 4"});
    expect_input_error([&] { parse("PK\3\4 a zip archive of arrays"); }, {"no .npy"});
    const std::string whole = npy_header(1, kTwoByThree) + data;
    for (size_t length = 0; length < whole.size(); ++length)
        expect_input_error([&] { parse(whole.substr(0, length)); }, {"a.npy"});
}

constexpr uint32_t kFrames = 5;

struct N3vTest : testing::Test {
    TemporaryFolder folder;
    std::vector<double> rows;

    void SetUp() override {
        for (int i = 0; i < 3; ++i) {
            write_video("cam0" + std::to_string(i) + ".mp4", 32, 24, i == 2 ? kFrames + 1 : kFrames);
            // A level camera at (i, 2, 3) that looks along −Z: down, right, backwards, position, (H, W, focal); nearest
            // and farthest depth.
            const std::vector<double> row = {0, 1, 0, 1.0 * i, 48, -1, 0, 0, 2, 64, 0, 0, 1, 3, 50.0 + 2 * i, 0.5, 9};
            rows.insert(rows.end(), row.begin(), row.end());
        }
        write_rows(3);
    }
    void write_video(const std::string& name, uint32_t width, uint32_t height, uint32_t frames) {
        media::VideoWriter video(folder.path / name, width, height, 30);
        for (uint32_t i = 0; i < frames; ++i) {
            media::Image image(width, height);
            std::fill(image.rgba.begin(), image.rgba.end(), static_cast<uint8_t>(30 + 40 * i));
            video.add(image);
        }
        video.finish();
    }
    void write_rows(int count) {
        write_text(
            folder.path / "poses_bounds.npy",
            npy_header(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(count) + ", 17), }") +
                bytes_of(rows));
    }
};

TEST_F(N3vTest, RowsAreCamerasAndTheFirstIsHeldOut) {
    const training::Rig train = training::read_rig(folder.path, training::Split::kTrain),
                        test = training::read_rig(folder.path, training::Split::kTest);
    EXPECT_EQ(train.format, "n3v");
    EXPECT_NEAR(train.fps, 30, 1e-6);
    ASSERT_EQ(train.cameras.size(), 2u);
    ASSERT_EQ(train.shots.size(), 2 * kFrames) << "the shortest video counts";
    ASSERT_EQ(test.cameras.size(), 1u);
    EXPECT_EQ(test.cameras[0].name, "cam00");
    const training::RigCamera& camera = train.cameras[1];
    EXPECT_EQ(camera.name, "cam02");
    const glm::dmat4 pose(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0),
                          glm::dvec4(2, 2, 3, 1));
    EXPECT_EQ(camera.world_from_camera, pose);
    EXPECT_EQ(camera.lens.fx, 27) << "54 for 64×48, and the video is 32×24";
    EXPECT_EQ(camera.lens.fy, 27);
    EXPECT_EQ(camera.lens.cx, 16);
    EXPECT_EQ(camera.lens.cy, 12);
    EXPECT_EQ(train.cameras[0].lens.fx, 26) << "a row's own focal length";
    EXPECT_EQ(train.shots[3].name, "cam01_f0003");
    EXPECT_EQ(train.shots[3].time, 0.75);
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kVal); }, {"n3v", "validation"});
}

TEST_F(N3vTest, MattesAreNeededAndLieBeside) {
    expect_input_error([&] { training::load_dataset(folder.path, training::Split::kTest); },
                       {"no image has a matte", "make mattes for"});
    std::filesystem::create_directories(folder.path / "mattes");
    media::Image matte(32, 24);
    for (size_t i = 0; i < 32 * 24; ++i) std::fill_n(&matte.rgba[4 * i], 3, static_cast<uint8_t>(i % 32 < 9 ? 255 : 0));
    for (size_t i = 3; i < matte.rgba.size(); i += 4) matte.rgba[i] = 255;
    for (uint32_t i = 0; i < kFrames; ++i)
        media::write_png(folder.path / "mattes" / ("cam00_f000" + std::to_string(i) + ".png"), matte);
    const training::Dataset data = training::load_dataset(folder.path, training::Split::kTest);
    ASSERT_EQ(data.views.size(), kFrames);
    EXPECT_EQ(data.times, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
    for (uint32_t i = 0; i < kFrames; ++i) {
        EXPECT_NEAR(data.views[i].image.at(4, 9)[0], 30 + 40 * i, 3);
        EXPECT_EQ(data.views[i].image.at(4, 9)[3], 255);
        EXPECT_EQ(data.views[i].image.at(20, 9)[3], 0);
    }
}

TEST_F(N3vTest, WhatDoesNotFitIsNamed) {
    const auto expect_bad = [&](std::initializer_list<std::string> parts) {
        expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); }, parts);
    };
    const std::vector<double> good = rows;
    rows[17] = 0.5;  // in row 1
    write_rows(3);
    expect_bad({"poses_bounds.npy", "row 1", "rigid"});
    rows = good;
    rows[34] = NAN;
    write_rows(3);
    expect_bad({"row 2"});
    rows = good;
    rows[17 + 14] = -4;
    write_rows(3);
    expect_bad({"row 1", "focal"});
    rows = good;
    rows[17 + 4] = 1e9;
    write_rows(3);
    expect_bad({"row 1", "image size"});
    rows = good;
    rows.resize(34);
    write_rows(2);
    expect_bad({"2 rows", "3 videos"});
    rows = good;
    write_text(folder.path / "poses_bounds.npy",
               npy_header(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (17, 3), }") + bytes_of(rows));
    expect_bad({"N×17"});
    write_rows(3);
    write_video("cam01.mp4", 32, 32, kFrames);
    expect_bad({"cam01.mp4", "32×32", "row 1", "64×48"});
    std::filesystem::remove(folder.path / "cam01.mp4");
    expect_bad({"3 rows", "2 videos"});
    write_text(folder.path / "cam01.mp4", "no video");
    expect_bad({"cam01.mp4"});
}

}  // namespace
}  // namespace neuvv
