// Data sets in which one of several files counts, names of other systems, and hidden files.
#include "training/data/layouts/rig/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/colmap_files.h"
#include "support/easymocap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/rig/camera_folders.h"

namespace neuvv {
namespace {

using nlohmann::json;
using training::Split;

struct Candidates : testing::Test {
    TemporaryFolder folder;

    void put_image(const std::string& name, uint32_t width = 64, uint32_t height = 48) const {
        test::write_grey_png(folder.path / name, width, height);
    }
    void date(const std::string& name, int days) const {
        const auto now = std::filesystem::file_time_type::clock::now();
        std::filesystem::last_write_time(folder.path / name, now - std::chrono::hours(24 * (10 - days)));
    }
    // Two cameras c0 and c1 of Pose2Sim, at this distance.
    static std::string toml(double distance) {
        std::string text;
        for (int i = 0; i < 2; ++i)
            text += fmt::format(
                "[c{0}]\nname = \"c{0}\"\nsize = [ 64.0, 48.0]\nmatrix = [ [ 90, 0, 31], [ 0, 90, 22], [ 0, 0, 1]]\n"
                "distortions = [ 0, 0, 0, 0]\nrotation = [ 0, 0, 0]\ntranslation = [ 0, {0}, {1}]\nfisheye = false\n",
                i, distance);
        return text;
    }
    static std::string remarks_of(const training::Rig& rig) {
        std::string text;
        for (const std::string& remark : rig.remarks) text += remark + "\n";
        return text;
    }
    training::Rig read(Split split = Split::kTrain) const { return training::read_rig(folder.path, split); }

    static test::ColmapSample colmap(size_t images, double distance) {
        test::ColmapSample sample;
        sample.cameras = {{1, 1, "PINHOLE", 64, 48, {60, 61, 32, 24}}};
        for (size_t i = 0; i < images; ++i) {
            const double half = 0.3 * static_cast<double>(i);
            sample.images.push_back({static_cast<int>(i),
                                     {std::cos(half), 0, std::sin(half), 0, 0, 0, distance},
                                     1,
                                     fmt::format("c{}.png", i)});
        }
        return sample;
    }
    static json pose(double x) { return {{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}; }
};

TEST_F(Candidates, TheNewestCalibrationCounts) {
    write_text(folder.path / "Calib_a.toml", toml(3));
    write_text(folder.path / "calibration" / "Calib_z.toml", toml(5));
    for (const char* name : {"c0.png", "c1.png"}) put_image(std::string("images/") + name);
    for (const int newest : {0, 1}) {
        date("Calib_a.toml", newest == 0 ? 5 : 1);
        date("calibration/Calib_z.toml", newest == 0 ? 1 : 5);
        const training::Rig rig = read();
        EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, newest == 0 ? -3 : -5, 1e-9) << "+Z is up in the file";
        EXPECT_EQ(remarks_of(rig),
                  newest == 0 ? "Calib_a.toml, the newest such file, was read, not calibration/Calib_z.toml\n"
                              : "calibration/Calib_z.toml, the newest such file, was read, not Calib_a.toml\n");
    }
    date("Calib_a.toml", 5);
    std::filesystem::last_write_time(folder.path / "calibration" / "Calib_z.toml",
                                     std::filesystem::last_write_time(folder.path / "Calib_a.toml"));
    EXPECT_NE(remarks_of(read()).find("the last by name of files of one date"), std::string::npos);
}

// In all layouts with images by camera: cameras called after serial numbers have the folders and videos that there are.
TEST_F(Candidates, CamerasWhoseNamesNobodyHasAreTakenInOrder) {
    write_text(folder.path / "Calib.toml", toml(3));
    for (const char* name : {"shots_2", "shots_10"}) put_image(std::string("images/") + name + "/000.png");
    training::Rig rig = read();
    EXPECT_EQ(rig.cameras.at(0).name, "shots_10");
    EXPECT_EQ(remarks_of(rig),
              "camera c0: images/shots_2/, by their order\ncamera c1: images/shots_10/, by their order\n");
    put_image("images/shots_3/000.png");
    expect_input_error([&] { read(); }, {"Calib.toml", "2 cameras", "images/ has the images of 3"});
    put_image("images/c1/000.png");
    expect_input_error([&] { read(); }, {"one camera with images"});
    std::filesystem::remove_all(folder.path / "images");
    std::filesystem::remove(folder.path / "Calib.toml");

    write_text(folder.path / "cameras.csv",
               "#name,x,y,alt,heading,pitch,roll,f\na.jpg,0,0,1,0,90,0,18\nb.jpg,0,0,2,0,90,0,18\n");
    for (const char* name : {"left", "right"}) put_image(std::string("images/") + name + "/000.png");
    rig = read();
    EXPECT_EQ(rig.format, "realitycapture");
    EXPECT_EQ(rig.cameras.at(0).name, "right");
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, 2, 1e-12);
}

TEST_F(Candidates, TablesOfRealityCaptureHaveDates) {
    for (const char* name : {"a.png", "b.png"}) put_image(std::string("images/") + name);
    const auto table = [](double height) {
        std::string text = "#name,x,y,alt,heading,pitch,roll,f\n";
        for (const char* name : {"a", "b"}) text += fmt::format("D:\\shoot\\{}.jpg,0,0,{},0,90,0,18\n", name, height);
        return text;
    };
    write_text(folder.path / "old.csv", table(1));
    write_text(folder.path / "new.CSV", table(2));
    date("old.csv", 1);
    const training::Rig rig = read();
    EXPECT_EQ(rig.cameras[0].name, "b") << "of a path of Windows, the file's name counts";
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, 2, 1e-12);
    EXPECT_NE(remarks_of(rig).find("new.CSV, the newest such file, was read, not old.csv"), std::string::npos);
}

TEST_F(Candidates, TheLargestModelOfColmapCounts) {
    const test::ColmapSample whole = colmap(4, 3), part = colmap(2, 9);
    for (const auto& image : whole.images) put_image("images/" + image.name);
    for (const bool binary : {true, false}) {
        test::write_colmap(folder.path / "sparse" / "0", part, binary);
        test::write_colmap(folder.path / "sparse" / "10", whole, binary);
        const training::Rig rig = read();
        EXPECT_EQ(rig.cameras.size(), 3u);
        EXPECT_NEAR(glm::length(glm::dvec3(rig.cameras[0].world_from_camera[3])), 3, 1e-9);
        EXPECT_EQ(rig.remarks.at(0), "sparse/10 with 4 images was read, not sparse/0 with 2 images");
        if (!binary) {
            EXPECT_EQ(rig.remarks.at(1), "images.bin was read, not images.txt");
        }
    }
    write_text(folder.path / "sparse" / "10" / "images.bin", "damaged");
    EXPECT_EQ(read().remarks.at(0), "sparse/0 with 2 images was read, not sparse/10, which cannot be read");
    test::write_colmap(folder.path / "sparse" / "10", part, true);
    EXPECT_EQ(read().remarks.at(0).find("sparse/0 with 2 images was read"), 0u) << "of models alike, the first";
}

TEST_F(Candidates, ImagesBeforeTheirSmallerCopies) {
    const test::ColmapSample sample = colmap(3, 3);
    test::write_colmap(folder.path / "sparse" / "0", sample, true);
    for (const auto& image : sample.images) {
        put_image("images_4/" + image.name, 16, 12);
        put_image("images_2/" + image.name, 32, 24);
    }
    const training::Rig half = read();
    EXPECT_EQ(half.shots[0].image.path, folder.path / "images_2" / "c1.png");
    EXPECT_NEAR(half.cameras[0].lens.fx, 30, 1e-9) << "the lens is that of the copies";
    EXPECT_EQ(half.remarks.at(0), "images_2/ was read, not images_4/");
    for (const auto& image : sample.images) put_image("images/" + image.name);
    const training::Rig full = read();
    EXPECT_NEAR(full.cameras[0].lens.fx, 60, 1e-9);
    EXPECT_EQ(full.remarks.at(0), "images/ was read, not images_2/, images_4/");
}

TEST_F(Candidates, BothAnglesOfViewCount) {
    json document = {{"camera_angle_x", 2 * std::atan(0.5)}, {"camera_angle_y", 2 * std::atan(0.25)}};
    for (int i = 0; i < 2; ++i) {
        put_image(fmt::format("c{}.png", i));
        document["frames"].push_back({{"file_path", fmt::format("c{}.png", i)}, {"transform_matrix", pose(i)}});
    }
    const auto lens = [&] {
        write_text(folder.path / "transforms.json", document.dump());
        return read().cameras.at(0).lens;
    };
    EXPECT_NEAR(lens().fx, 64, 1e-9);
    EXPECT_NEAR(lens().fy, 96, 1e-9);
    document["fl_y"] = 70;
    EXPECT_NEAR(lens().fx, 64, 1e-9);
    EXPECT_NEAR(lens().fy, 70, 1e-9);
    document.erase("fl_y");
    document["fl_x"] = 50;
    EXPECT_NEAR(lens().fx, 50, 1e-9);
    EXPECT_NEAR(lens().fy, 96, 1e-9) << "each axis by itself, as in instant-ngp";
    EXPECT_NE(remarks_of(read()).find("fl_x was read, not camera_angle_x, which contradicts it"), std::string::npos);
    document["fl_x"] = 64;
    EXPECT_EQ(lens().fx, 64);
    EXPECT_TRUE(read().remarks.empty()) << remarks_of(read());
    for (const char* key : {"fl_x", "camera_angle_x"}) document.erase(key);
    EXPECT_NEAR(lens().fx, 96, 1e-9) << "what one axis has is that of both";
}

TEST_F(Candidates, OtherTransformsAndTwinsAreNamed) {
    json document = {{"fl_x", 60}};
    for (int i = 0; i < 2; ++i) {
        put_image(fmt::format("images\\c{}.png", i).replace(6, 1, "/"));
        document["frames"].push_back({{"file_path", fmt::format("images\\c{}", i)}, {"transform_matrix", pose(i)}});
    }
    write_text(folder.path / "transforms.json", document.dump());
    write_text(folder.path / "transforms_undistorted.json", "{}");
    std::filesystem::copy(folder.path / "images" / "c1.png", folder.path / "images" / "c1.jpg");
    test::write_colmap(folder.path / "sparse" / "0", colmap(2, 3), true);
    const training::Rig rig = read();
    EXPECT_EQ(rig.shots[0].image.path, folder.path / "images" / "c1.png");
    EXPECT_NE(remarks_of(rig).find("transforms.json was read, not transforms_undistorted.json"), std::string::npos);
    EXPECT_NE(remarks_of(rig).find("images/c1.png was read, not images/c1.jpg"), std::string::npos) << remarks_of(rig);
    EXPECT_NE(remarks_of(rig).find("read as nerf; the folder also has files of colmap"), std::string::npos);
    const training::Rig named = training::read_rig(folder.path, Split::kTrain, "nerf");
    EXPECT_EQ(remarks_of(named).find("read as nerf"), std::string::npos);
    for (const char* path : {"..\\c0.png", "C:\\shoot\\c0.png"}) {
        document["frames"][0]["file_path"] = path;
        write_text(folder.path / "transforms.json", document.dump());
        expect_input_error([&] { read(); }, {"frames[0].file_path", "folder"});
    }
}

struct EasyCandidates : Candidates {
    EasyCandidates() {
        const std::vector<std::string> names = {"a", "b", "c"};
        std::string intrinsics = test::yaml_names(names), extrinsics = intrinsics;
        for (const std::string& name : names) {
            intrinsics += test::yaml_matrix("K_" + name, 3, 3, {90, 0, 31, 0, 95, 22, 0, 0, 1});
            extrinsics += test::yaml_matrix("R_" + name, 3, 1, {0, 0, 0});
            extrinsics += test::yaml_matrix("T_" + name, 3, 1, {0.0 + name[0] - 'a', 0, 4});
            for (int frame = 0; frame < 2; ++frame) put_image(fmt::format("images/{}/{}.png", name, frame));
        }
        write_text(folder.path / "intri.yml", intrinsics);
        write_text(folder.path / "extri.yml", extrinsics);
    }
};

TEST_F(EasyCandidates, HiddenFilesAreNone) {
    for (const char* name : {"images/a/._0.png", "images/b/.DS_Store.png", "masks/a/._0.png", "._intri.yml", ".x.csv"})
        write_text(folder.path / name, "no image");
    for (const char* name : {"a", "b", "c"})
        for (int frame = 0; frame < 2; ++frame) put_image(fmt::format("masks/{}/{}.png", name, frame));
    const training::Rig rig = read(), held_out = read(Split::kTest);
    EXPECT_EQ(rig.shots.size(), 4u);
    EXPECT_EQ(held_out.shots.size(), 2u);
    EXPECT_TRUE(rig.remarks.empty()) << remarks_of(rig);
    EXPECT_EQ(training::entries_of(folder.path / "images" / "a").size(), 2u);
}

TEST_F(EasyCandidates, WhatWasNotReadIsNamed) {
    write_text(folder.path / "intri_opt.yml", "%YAML:1.0");
    write_text(folder.path / "b.m4v", "");
    put_image("c/0.png");
    put_image("mask_cihp/x.png");
    for (const char* name : {"a", "b", "c"})
        for (int frame = 0; frame < 2; ++frame) put_image(fmt::format("mask/{}/{}.png", name, frame));
    const std::string remarks = remarks_of(read());
    EXPECT_NE(remarks.find("intri.yml was read, not intri_opt.yml"), std::string::npos) << remarks;
    EXPECT_NE(remarks.find("images/b was read, not b.m4v, and alike in 2 cases"), std::string::npos) << remarks;
    EXPECT_NE(remarks.find("mask/ was read, not mask_cihp/"), std::string::npos) << remarks;
}

TEST_F(EasyCandidates, MasksAreNamedAsColmapNamesThem) {
    for (const char* name : {"a", "b", "c"})
        for (int frame = 0; frame < 2; ++frame) put_image(fmt::format("masks/{}/{}.png.png", name, frame));
    const training::Rig rig = read();
    EXPECT_EQ(rig.shots[1].mask.path, folder.path / "masks" / "b" / "1.png.png");
    std::filesystem::remove(folder.path / "masks" / "b" / "1.png.png");
    expect_input_error([&] { read(); }, {"masks/b", "1.png"});
}

TEST_F(Candidates, ColmapsMasksInEachMode) {
    test::ColmapSample sample = colmap(3, 3);
    for (auto& image : sample.images) image.name.replace(2, 4, "\\0.png");
    test::write_colmap(folder.path / "sparse" / "0", sample, true);
    for (int i = 0; i < 3; ++i)
        for (int frame = 0; frame < 2; ++frame) {
            put_image(fmt::format("images/c{}/{}.png", i, frame));
            put_image(fmt::format("masks/c{}/{}.png.png", i, frame));
        }
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 4u) << "a backslash in images.bin parts a folder from its file";
    EXPECT_EQ(rig.shots[1].mask.path, folder.path / "masks" / "c1" / "1.png.png");
}

TEST_F(Candidates, EndingsOfVideosInAnyCase) {
    for (const char* name : {"a.m4v", "a.MTS", "a.m2ts", "a.Mov", "a.MP4", "a.mxf", "a.AVI"})
        EXPECT_TRUE(training::is_video(name)) << name;
    for (const char* name : {"a.txt", "a.png", "mp4", "a.mp3", "a.json"})
        EXPECT_FALSE(training::is_video(name)) << name;
    put_image("images/c0/0.png");
    std::filesystem::create_directories(folder.path / "videos");
    write_text(folder.path / "videos" / "c1.M4v", "");
    EXPECT_EQ(training::names_of_images(folder.path).names, (std::vector<std::string>{"c0"}));
    std::filesystem::remove_all(folder.path / "images");
    EXPECT_EQ(training::names_of_images(folder.path).names, (std::vector<std::string>{"c1"}));
    EXPECT_TRUE(training::has_images(folder.path, "c1"));
    write_text(folder.path / "videos" / "c2.mp4", "");
    write_text(folder.path / "videos" / "c2.MOV", "");
    expect_input_error([&] { training::has_images(folder.path, "c2"); }, {"c2.MOV", "c2.mp4"});
}

TEST_F(Candidates, CaliscopesCamerasAreRecognised) {
    const auto camera = [](int id, const std::string& more, const char* rotation) {
        return fmt::format(
            "[cameras.{0}]\ncam_id = {0}\nsize = [64, 48]\nrotation_count = 0\n{1}matrix = [[90.0, 0.0, 31.0], "
            "[0.0, 90.0, 22.0], [0.0, 0.0, 1.0]]\ndistortions = [0.0, 0.0, 0.0, 0.0, 0.0]\n{2}\n",
            id, more, rotation);
    };
    const char* vector = "translation = [0.0, 0.0, 4.0]\nrotation = [0.0, 0.0, 0.0]";
    const char* matrix = "translation = [0.0, 1.0, 4.0]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    write_text(folder.path / "camera_array.toml", camera(0, "", vector) + camera(1, "", matrix) +
                                                      camera(2, "ignore = true\n", vector) + camera(10, "", vector) +
                                                      camera(11, "", ""));
    for (const char* name : {"cam_0", "cam_2", "port_10", "cam_1"}) put_image(fmt::format("images/{}.png", name));
    const training::Rig rig = read();
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[0].name, "cam_1");
    EXPECT_EQ(rig.cameras[1].name, "port_10") << "by number";
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].y, -4, 1e-12);
    EXPECT_NEAR(rig.cameras[0].world_from_camera[3].z, 1, 1e-12);
    EXPECT_EQ(rig.world, "metres, as Caliscope has them; +Y up, turned from +Z up");
    EXPECT_EQ(remarks_of(rig), "Caliscope ignores or has not calibrated the cameras 11 2\n");
}

}  // namespace
}  // namespace neuvv
