// Camera paths as instant-ngp, nerfstudio and NeuVV write them.
#include "interchange/camera/camera_path_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/error.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180;

struct CameraPathFile : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path where = folder.path / "path.json";

    stage::CameraPath read(const json& document) {
        write_text(where, document.dump());
        return interchange::read_camera_path(where, 25);
    }
    void expect_bad(json document, const std::function<void(json&)>& damage, std::initializer_list<std::string> parts) {
        damage(document);
        expect_input_error([&] { read(document); }, parts);
    }
};

// Expects a level camera at `position` that looks along −Z, turned by `yaw_deg` about +Y.
void expect_pose(const stage::CameraPathKey& key, glm::dvec3 position, double yaw_deg) {
    EXPECT_LT(glm::distance(key.position, position), 1e-9)
        << key.position.x << " " << key.position.y << " " << key.position.z;
    const glm::dquat turn = glm::angleAxis(yaw_deg * kDegree, glm::dvec3(0, 1, 0));
    EXPECT_NEAR(std::abs(glm::dot(key.world_from_camera, turn)), 1, 1e-9);
}

// instant-ngp maps positions p of the data set to cycle(p · 0.33 + 0.5), where cycle takes (x, y, z) to (y, z, x), and
// flips the y and z axes of cameras. The data set has +Z up. A level camera at (1, −3, 2) in it looks along +Y; with +Y
// up it stands at (1, 2, 3) and looks along −Z. In the data set its axes are right (1, 0, 0), down (0, 0, −1), forwards
// (0, 1, 0); in the cube they are (0, 0, 1), (0, −1, 0), (1, 0, 0).
json ngp_file() {
    const double s = std::sqrt(0.5);
    // The rotation with these columns is that by 180° about (1, 0, 1)/√2: x ↦ z, y ↦ −y, z ↦ x.
    const json r = {s, 0, s, 0};
    const auto cube = [](double x, double y, double z) { return json{y * 0.33 + 0.5, z * 0.33 + 0.5, x * 0.33 + 0.5}; };
    json path = {{"loop", false}, {"time", 0.3}, {"duration_seconds", 6.0}, {"spline_order", 3}};
    for (int i = 0; i < 4; ++i)
        path["path"].push_back({{"R", r},
                                {"T", cube(1.0 + i, -3, 2)},
                                {"slice", 0},
                                {"scale", 1.5},
                                {"fov", 40.0 + i},
                                {"aperture_size", 0},
                                {"timestamp", (i + 1) * 0.25}});
    return path;
}

TEST_F(CameraPathFile, InstantNgp) {
    const stage::CameraPath path = read(ngp_file());
    ASSERT_EQ(path.keys.size(), 4u);
    EXPECT_EQ(path.interpolation, stage::Interpolation::kSmooth);
    EXPECT_FALSE(path.cyclic);
    EXPECT_EQ(path.width, 0u);
    // A timestamp is the time of the next key: the first key is at 0, the last at the timestamp of the third, here 6 s.
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(path.keys[i].time_s, 2.0 * static_cast<double>(i), 1e-12);
        expect_pose(path.keys[i], {1.0 + static_cast<double>(i), 2, 3}, 0);
        EXPECT_NEAR(path.keys[i].angle_y, (40.0 + static_cast<double>(i)) * kDegree, 1e-12);
    }
    EXPECT_NEAR(path.duration_s, 6, 1e-12);
}

TEST_F(CameraPathFile, InstantNgpLoopsAndOldFiles) {
    json file = ngp_file();
    file["loop"] = true;
    file["spline_order"] = 1;
    const stage::CameraPath loop = read(file);
    EXPECT_TRUE(loop.cyclic);
    EXPECT_EQ(loop.interpolation, stage::Interpolation::kLinear);
    EXPECT_EQ(loop.duration_s, 6);
    EXPECT_NEAR(loop.keys[3].time_s, 4.5, 1e-12);
    for (const char* name : {"loop", "duration_seconds", "spline_order"}) file.erase(name);
    for (json& key : file["path"]) key.erase("timestamp");
    const stage::CameraPath old = read(file);
    EXPECT_EQ(old.interpolation, stage::Interpolation::kSmooth);
    EXPECT_NEAR(old.keys[1].time_s, 5.0 / 3, 1e-12) << "evenly over instant-ngp's five seconds";
    EXPECT_NEAR(old.duration_s, 5, 1e-12);
    file["scale"] = 0.5;  // those of the data set's transforms.json, added by hand
    file["offset"] = {0, 0, 0};
    EXPECT_NEAR(read(file).keys[0].position.x, (0.33 + 0.5) / 0.5, 1e-12);
}

TEST_F(CameraPathFile, InstantNgpDamageIsNamed) {
    const json good = ngp_file();
    expect_bad(good, [](json& j) { j["path"] = json::array(); }, {"path.json", "path", "empty"});
    expect_bad(good, [](json& j) { j["path"] = 3; }, {"path", "array"});
    expect_bad(good, [](json& j) { j["path"][2].erase("R"); }, {"path[2]", "has no R"});
    expect_bad(good, [](json& j) { j["path"][2]["R"] = {0, 0, 0, 0}; }, {"path[2].R", "unit quaternion"});
    expect_bad(good, [](json& j) { j["path"][2]["R"] = {0, 0, 1}; }, {"path[2].R", "3 entries"});
    expect_bad(good, [](json& j) { j["path"][1]["T"][0] = "x"; }, {"path[1].T[0]", "number"});
    expect_bad(good, [](json& j) { j["path"][1]["T"][0] = 1e30; }, {"path[1]", "m from the origin"});
    expect_bad(good, [](json& j) { j["path"][1]["fov"] = 0; }, {"path[1].fov", "angle of view"});
    expect_bad(good, [](json& j) { j["duration_seconds"] = -1; }, {"duration_seconds"});
    expect_bad(good, [](json& j) { j["loop"] = "yes"; }, {"loop", "neither true nor false"});
    expect_bad(good, [](json& j) { j["scale"] = 0; }, {"scale"});
    expect_bad(good, [](json& j) { j["path"][1] = 5; }, {"path[1]"});
}

// A camera at (x, −3, 2) that looks along +Y in a world with +Z up; row by row.
json nerfstudio_matrix(double x) {
    return {1, 0, 0, x, 0, 0, -1, -3, 0, 1, 0, 2, 0, 0, 0, 1};
}

json nerfstudio_file() {
    json file = {{"camera_type", "perspective"},
                 {"render_height", 540},
                 {"render_width", 960},
                 {"fps", 24},
                 {"seconds", 0.25},
                 {"smoothness_value", 0.5},
                 {"is_cycle", false},
                 {"crop", nullptr},
                 {"default_fov", 50.0},
                 {"default_transition_sec", 2.0}};
    for (int i = 0; i < 6; ++i)
        file["camera_path"].push_back(
            {{"camera_to_world", nerfstudio_matrix(i)}, {"fov", 50.0 + i}, {"aspect", 16.0 / 9}});
    for (int i = 0; i < 3; ++i)
        file["keyframes"].push_back({{"matrix", nerfstudio_matrix(10 * i)},
                                     {"fov", 30.0},
                                     {"aspect", 1.0},
                                     {"override_transition_enabled", i == 2},
                                     {"override_transition_sec", i == 2 ? json(0.5) : json()}});
    return file;
}

TEST_F(CameraPathFile, Nerfstudio) {
    json file = nerfstudio_file();
    const stage::CameraPath path = read(file);
    ASSERT_EQ(path.keys.size(), 6u);
    EXPECT_EQ(path.width, 960u);
    EXPECT_EQ(path.height, 540u);
    for (size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(path.keys[i].time_s, static_cast<double>(i) / 24, 1e-12);
        expect_pose(path.keys[i], {static_cast<double>(i), 2, 3}, 0);
        EXPECT_NEAR(path.keys[i].angle_y, (50.0 + static_cast<double>(i)) * kDegree, 1e-12);
        EXPECT_FALSE(path.keys[i].clip_time);
    }
    EXPECT_NEAR(path.duration_s, 5.0 / 24, 1e-12);
    file["is_cycle"] = true;
    for (size_t i = 0; i < 6; ++i) file["camera_path"][i]["render_time"] = static_cast<double>(i) / 5;
    const stage::CameraPath cycle = read(file);
    EXPECT_TRUE(cycle.cyclic);
    EXPECT_NEAR(cycle.duration_s, 0.25, 1e-12);
    EXPECT_EQ(cycle.keys[1].clip_time, 0.2);
}

TEST_F(CameraPathFile, NerfstudioKeyframesAlone) {
    json file = nerfstudio_file();
    file["camera_path"] = json::array();
    const stage::CameraPath path = read(file);
    ASSERT_EQ(path.keys.size(), 3u);
    expect_pose(path.keys[2], {20, 2, 3}, 0);
    EXPECT_EQ(path.keys[1].time_s, 2);
    EXPECT_EQ(path.keys[2].time_s, 2.5);
    file["is_cycle"] = true;
    EXPECT_EQ(read(file).duration_s, 4.5) << "two seconds from the last to the first";
    file["keyframes"][0]["matrix"] = "[1,0,0,0]";
    expect_input_error([&] { read(file); }, {"keyframes[0].matrix", "text"});
}

// nerfstudio's world is that of the data set, transformed and scaled; this is undone where the file has both numbers.
TEST_F(CameraPathFile, NerfstudioWorldsCanBeUndone) {
    json file = nerfstudio_file();
    file["scale"] = 0.5;
    file["transform"] = {{0, -1, 0, 7}, {1, 0, 0, 8}, {0, 0, 1, 9}};  // a quarter turn about Z, then moved
    // (2, −3, 2) / 0.5 − (7, 8, 9) = (−3, −14, −5), turned back: (−14, 3, −5); with +Y up: (−14, −5, −3). The view
    // along +Y becomes one along +X, which is −Z turned by −90° about +Y.
    expect_pose(read(file).keys[2], {-14, -5, -3}, -90);
}

TEST_F(CameraPathFile, NerfstudioDamageIsNamed) {
    const json good = nerfstudio_file();
    expect_bad(good, [](json& j) { j["camera_type"] = "fisheye"; }, {"camera_type", "perspective"});
    expect_bad(good, [](json& j) { j.erase("fps"); }, {"path.json", "fps"});
    expect_bad(good, [](json& j) { j["fps"] = 0; }, {"fps"});
    expect_bad(good, [](json& j) { j["render_width"] = 0; }, {"render_width"});
    expect_bad(good, [](json& j) { j["camera_path"] = 5; }, {"camera_path", "array"});
    expect_bad(good, [](json& j) { j["camera_path"][3].erase("camera_to_world"); },
               {"camera_path[3]", "camera_to_world"});
    expect_bad(good, [](json& j) { j["camera_path"][3]["camera_to_world"].erase(0); },
               {"camera_path[3]", "15 entries"});
    expect_bad(good, [](json& j) { j["camera_path"][3]["camera_to_world"][0] = 2; }, {"camera_path[3]", "scaled"});
    expect_bad(good, [](json& j) { j["camera_path"][3]["camera_to_world"][12] = 5; }, {"camera_path[3]", "0 0 0 1"});
    expect_bad(good, [](json& j) { j["camera_path"][3]["fov"] = 180; }, {"camera_path[3].fov"});
    expect_bad(good, [](json& j) { j["camera_path"][3]["render_time"] = 2; }, {"camera_path[3].render_time"});
    expect_bad(good, [](json& j) { j.erase("camera_path"), j.erase("keyframes"); }, {"path.json", "no camera path"});
}

TEST_F(CameraPathFile, OursRoundTrips) {
    stage::CameraPath path;
    path.cyclic = true;
    path.duration_s = 4.75;
    path.interpolation = stage::Interpolation::kLinear;
    for (int i = 0; i < 3; ++i) {
        stage::CameraPathKey key;
        key.time_s = 1.1 * i;
        key.position = {1.0 / 3, -2.5 * i, 1e-3};
        key.world_from_camera = glm::normalize(glm::dquat(0.3, 0.1 * i, -0.7, 0.2));
        key.angle_y = 0.3 + 0.1 * i;
        if (i != 1) key.clip_time = i / 2.0;
        path.keys.push_back(key);
    }
    for (const bool sized : {false, true}) {
        path.width = sized ? 1920 : 0;
        path.height = sized ? 800 : 0;
        if (sized) path.keys[1].stretch = 1.1;
        if (sized) path.keys[2].shift = {0.05, -0.25};
        interchange::write_camera_path(where, path);
        EXPECT_EQ(folder.entries(), 1u);
        const stage::CameraPath back = interchange::read_camera_path(where, 25);
        ASSERT_EQ(back.keys.size(), 3u);
        EXPECT_EQ(back.cyclic, path.cyclic);
        EXPECT_EQ(back.duration_s, path.duration_s);
        EXPECT_EQ(back.interpolation, path.interpolation);
        EXPECT_EQ(back.width, path.width);
        EXPECT_EQ(back.height, path.height);
        for (size_t i = 0; i < 3; ++i) {
            const stage::CameraPathKey &a = path.keys[i], &b = back.keys[i];
            EXPECT_EQ(b.time_s, a.time_s);
            EXPECT_EQ(b.position, a.position);
            EXPECT_NEAR(std::abs(glm::dot(b.world_from_camera, a.world_from_camera)), 1, 1e-12);
            EXPECT_NEAR(b.angle_y, a.angle_y, 1e-12);
            EXPECT_NEAR(b.stretch, a.stretch, 1e-12);
            EXPECT_NEAR(glm::distance(b.shift, a.shift), 0, 1e-12);
            EXPECT_EQ(b.clip_time, a.clip_time);
        }
    }
}

// Whatever bytes are damaged, the result is an InputError or a path that can be followed.
TEST_F(CameraPathFile, DamagedBytesDoNoHarm) {
    uint32_t state = 5;
    const auto below = [&](size_t end) { return (state = state * 1664525 + 1013904223) / 65536 % end; };
    for (const std::string& whole : {ngp_file().dump(), nerfstudio_file().dump()})
        for (int round = 0; round < 500; ++round) {
            std::string bytes = whole;
            for (int i = 0; i < 3; ++i) bytes[below(bytes.size())] = "0123456789-e.,:[]{}\"tn"[below(22)];
            write_text(where, bytes);
            try {
                const stage::CameraPath path = interchange::read_camera_path(where, 25);
                for (int i = -2; i < 12; ++i) {
                    const stage::Camera camera = stage::camera_at(path, 0.1 * i * path.duration_s, 64, 48);
                    ASSERT_TRUE(std::isfinite(camera.fx) && std::isfinite(glm::determinant(camera.world_from_camera)));
                }
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find("path.json"), std::string::npos);
            }
        }
}

json transforms_key(double z) {
    return {{"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, 1, z}, {0, 0, 0, 1}}}};
}

// Files without seconds, as `neuvv capture` writes them, have separate views, each shown for one image.
TEST_F(CameraPathFile, FramesWithoutSecondsAreViews) {
    json document = {{"camera_angle_x", 0.8}};
    document["frames"].push_back(transforms_key(2));
    document["frames"].push_back(transforms_key(3));
    document["frames"][1].update({{"time", 0.25}, {"w", 100}, {"h", 50}});
    const stage::CameraPath path = read(document);
    ASSERT_EQ(path.keys.size(), 2u);
    EXPECT_EQ(path.interpolation, stage::Interpolation::kCut);
    EXPECT_EQ(path.width, 0u);
    EXPECT_FALSE(path.keys[0].clip_time);
    EXPECT_EQ(path.keys[0].angle_x, 0.8);
    EXPECT_EQ(path.keys[1].time_s, 1 / 25.0);
    EXPECT_EQ(path.keys[1].clip_time, 0.25);
    EXPECT_NEAR(stage::camera_at(path, 1 / 25.0, 100, 50).fx, 50 / std::tan(0.4), 1e-9);
    EXPECT_NEAR(stage::camera_at(path, 0, 300, 50).fx, 150 / std::tan(0.4), 1e-9);
    document["frames"][0]["fl_x"] = 500;
    expect_input_error([&] { read(document); }, {"path.json", "frames[0]", "w and h"});
    expect_input_error([&] { interchange::read_camera_path(folder.path / "none.json", 25); }, {"none.json"});
}

TEST_F(CameraPathFile, OursIsCheckedToo) {
    json good = {{"camera_angle_y", 0.8}};
    for (int i = 0; i < 3; ++i) {
        good["frames"].push_back(transforms_key(i));
        good["frames"].back()["seconds"] = 0.5 * i;
    }
    EXPECT_EQ(read(good).duration_s, 1);
    EXPECT_EQ(read(good).interpolation, stage::Interpolation::kSmooth);
    EXPECT_EQ(read(good).keys[0].angle_y, 0.8);
    expect_bad(good, [](json& j) { j["frames"][1].erase("seconds"); }, {"frames[1]", "no seconds"});
    expect_bad(good, [](json& j) { j["frames"][2]["seconds"] = 0.5; }, {"frames[2]", "ascend"});
    expect_bad(good, [](json& j) { j["frames"][0]["seconds"] = -1; }, {"frames[0].seconds"});
    expect_bad(good, [](json& j) { j["interpolation"] = "bumpy"; }, {"interpolation", "smooth, linear or cut"});
    expect_bad(good, [](json& j) { j["loop"] = true; }, {"frames[2]", "loop"});
    expect_bad(good, [](json& j) { j["duration_seconds"] = 0.9; }, {"frames[2]", "duration"});
    expect_bad(good, [](json& j) { j["camera_angle_y"] = 4; }, {"camera_angle_y", "vertical"});
    expect_bad(good, [](json& j) { j["w"] = j["h"] = 10, j["k1"] = 0.1; }, {"frames[0]", "pinholes"});
}

}  // namespace
}  // namespace neuvv
