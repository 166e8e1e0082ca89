// The stage's camera path, edited key by key.
#include <gtest/gtest.h>

#include "edit/operations.h"
#include "stage/camera_path_json.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/edit/foreign_stage.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;

constexpr double kFrame = 0.04;

stage::CameraPathKey key(double time_s, double x = 0) {
    stage::CameraPathKey made;
    made.time_s = time_s;
    made.position = {x, 1, 4};
    made.world_from_camera = glm::angleAxis(0.1 * x, glm::normalize(glm::dvec3(0.1, 1, 0)));
    made.angle_y = 0.5 + 0.01 * x;
    return made;
}

struct Paths : test::ForeignStage {
    // The camera path as it would be read back.
    stage::CameraPath path() const {
        stage::expect_sound_document(file);
        return stage::make_stage(file).settings.camera_path.value();
    }
    ordered_json& json() { return file.json.edit("scenes")[0]["extensions"]["NEUVV_stage"]["cameraPath"]; }
    std::vector<double> times() const {
        std::vector<double> all;
        for (const stage::CameraPathKey& one : path().keys) all.push_back(one.time_s);
        return all;
    }
};

using Times = std::vector<double>;

TEST_F(Paths, AreKeptAsTheyAre) {
    for (const stage::Interpolation interpolation :
         {stage::Interpolation::kSmooth, stage::Interpolation::kLinear, stage::Interpolation::kCut}) {
        stage::CameraPath wanted{
            {key(0.5), key(1.25, 3), key(2, -1)}, interpolation, interpolation == stage::Interpolation::kSmooth, 3};
        edit::set_camera_path(file, wanted);
        stage::save_stage_file(file, folder.path / "with path.gltf");
        const stage::CameraPath kept = stage::load_stage(folder.path / "with path.gltf").settings.camera_path.value();
        EXPECT_EQ(kept.interpolation, interpolation);
        EXPECT_EQ(kept.cyclic, wanted.cyclic);
        EXPECT_EQ(kept.duration_s, 3);
        for (double t = -1; t < 8; t += 0.13) {
            const stage::Camera a = stage::camera_at(wanted, t, 64, 48), b = stage::camera_at(kept, t, 64, 48);
            for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(a.world_from_camera[c] - b.world_from_camera[c]), 1e-12);
            EXPECT_NEAR(a.fy, b.fy, 1e-9);
        }
    }
    EXPECT_EQ(edit::set_camera_path(file, {}), "no camera path");
    EXPECT_EQ(file.json, before);
}

TEST_F(Paths, KeysAreAddedInTime) {
    edit::add_path_key(file, key(2, 1), kFrame);
    EXPECT_EQ(path().duration_s, 2);
    edit::add_path_key(file, key(0, 2), kFrame);
    edit::add_path_key(file, key(4, 3), kFrame);
    EXPECT_EQ(times(), (Times{0, 2, 4}));
    EXPECT_EQ(path().duration_s, 4) << "it ends with its last key";
    json()["keys"][1]["why"] = "mine";
    EXPECT_NE(edit::add_path_key(file, key(2.019, 5), kFrame).find("replaced"), std::string::npos);
    EXPECT_EQ(times(), (Times{0, 2.019, 4}));
    EXPECT_EQ(path().keys[1].position.x, 5);
    EXPECT_EQ(json()["keys"][1]["why"], "mine");
    EXPECT_NE(edit::add_path_key(file, key(2.04, 6), kFrame).find("added"), std::string::npos)
        << "half a frame and more off";
    EXPECT_EQ(path().keys.size(), 4u);
}

TEST_F(Paths, KeysMovePastEachOtherAndGo) {
    for (const double t : {0.0, 1.0, 2.0, 3.0}) edit::add_path_key(file, key(t, t), kFrame);
    const stage::StageJson four = file.json;
    edit::move_path_key(file, 1, 2.5, kFrame);
    EXPECT_EQ(times(), (Times{0, 2, 2.5, 3}));
    EXPECT_EQ(path().keys[2].position.x, 1);
    edit::move_path_key(file, 3, 6, kFrame);
    EXPECT_EQ(path().duration_s, 6);
    edit::move_path_key(file, 3, 2.7, kFrame);
    EXPECT_EQ(path().duration_s, 2.7) << "the end follows the last key back";
    file.json = four;
    edit::move_path_key(file, 0, 2.01, kFrame);
    EXPECT_EQ(times(), (Times{1, 2.01, 3})) << "in the place of the key at 2 s";
    EXPECT_EQ(path().keys[1].position.x, 0);
    edit::remove_path_key(file, 2);
    EXPECT_EQ(path().duration_s, 2.01);
    expect_input_error([&] { edit::remove_path_key(file, 2); }, {"no key 2", "0 to 1"});
    expect_input_error([&] { edit::move_path_key(file, 9, 1, kFrame); }, {"no key 9"});
    edit::remove_path_key(file, 0);
    EXPECT_NE(edit::remove_path_key(file, 0).find("no camera path"), std::string::npos);
    EXPECT_EQ(file.json, before);
    expect_input_error([&] { edit::remove_path_key(file, 0); }, {"no key 0"});
}

TEST_F(Paths, CyclesKeepTimeToComeBack) {
    edit::set_camera_path(file, stage::CameraPath{{key(0), key(1, 1)}, stage::Interpolation::kSmooth, true, 3});
    edit::add_path_key(file, key(2, 2), kFrame);
    EXPECT_EQ(path().duration_s, 3);
    edit::add_path_key(file, key(3, 3), kFrame);
    EXPECT_EQ(path().duration_s, 4) << "as long as from key to key";
    edit::remove_path_key(file, 3);
    EXPECT_EQ(path().duration_s, 4) << "a cycle's length is its own";
    edit::move_path_key(file, 2, 8, kFrame);
    EXPECT_EQ(path().duration_s, 12);
    edit::remove_path_key(file, 0);
    edit::remove_path_key(file, 0);
    EXPECT_EQ(times(), (Times{8}));
}

TEST_F(Paths, OpenPathsMayRestAtTheirEnd) {
    edit::set_camera_path(file, stage::CameraPath{{key(0), key(1, 1)}, stage::Interpolation::kLinear, false, 5});
    edit::add_path_key(file, key(2, 2), kFrame);
    EXPECT_EQ(path().duration_s, 5);
    edit::add_path_key(file, key(6, 2), kFrame);
    EXPECT_EQ(path().duration_s, 6);
    json()["later"] = 1;
    stage::CameraPath changed = path();
    json()["keys"][1]["why"] = "mine";
    changed.interpolation = stage::Interpolation::kSmooth;
    edit::set_camera_path(file, changed);
    EXPECT_FALSE(json().contains("interpolation")) << "the default";
    EXPECT_EQ(json()["later"], 1);
    EXPECT_EQ(json()["keys"][1]["why"], "mine");
}

TEST_F(Paths, WhatAStageCannotKeepIsRefused) {
    stage::CameraPath wide{{key(0)}, stage::Interpolation::kSmooth, false, 0};
    wide.keys[0].angle_x = 1;
    expect_input_error([&] { edit::set_camera_path(file, wide); }, {"cameraPath/keys/0", "angle"});
    wide.keys[0].angle_x.reset();
    wide.keys[0].shift = {0.1, 0};
    expect_input_error([&] { edit::set_camera_path(file, wide); }, {"cameraPath/keys/0", "shifted"});
    EXPECT_EQ(file.json, before);
    stage::CameraPathKey bad = key(-1);
    edit::add_path_key(file, bad, kFrame);
    expect_input_error([&] { stage::expect_sound_document(file); }, {"cameraPath/keys/0/time"});
}

TEST_F(Paths, AStageWithoutItsExtensionGetsIt) {
    write_text(folder.path / "plain.gltf", R"({"asset":{"version":"2.0"},"nodes":[{"name":"a"}]})");
    file = stage::read_stage_file(folder.path / "plain.gltf");
    edit::add_path_key(file, key(7), kFrame);
    EXPECT_EQ(file.json["extensionsUsed"], ordered_json({"NEUVV_stage"}));
    EXPECT_EQ(stage::make_stage(file).duration_s, 7) << "the stage lasts as long as its path";
    edit::set_camera_path(file, {});
    EXPECT_FALSE(file.json.contains("extensionsUsed"));
}

}  // namespace
}  // namespace neuvv
