// `neuvv stage` on the command line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "interchange/splats/splat_gltf.h"
#include "interchange/usd/usd_xform.h"
#include "stage/evaluated_stage.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/stage/stage_files.h"
#include "tests/tools/run_neuvv.h"
#include "tools/stage/stage_verbs.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

struct StageVerb : testing::Test {
    TemporaryFolder folder;
    std::string file(const std::string& name) const { return (folder.path / name).string(); }
    std::string show = (folder.path / "show.gltf").string(), clip = (folder.path / "eva.nvv").string();

    void SetUp() override { test::put_clip(clip); }
    void expect_done(const std::vector<std::string>& arguments, const std::string& said = "") {
        std::vector<std::string> all = {"stage"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const ProgramResult result = run_neuvv(all);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_NE(result.out.find(said), std::string::npos) << result.out;
    }
    nlohmann::json info(const std::vector<std::string>& more = {}) {
        std::vector<std::string> all = {"stage", "info", show, "--json"};
        all.insert(all.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(all);
        EXPECT_EQ(result.code, 0) << result.err;
        return nlohmann::json::parse(result.out);
    }
};

TEST_F(StageVerb, EveryOneHelpsWithExamples) {
    for (const char* verb : {"new", "add", "set", "duplicate", "remove", "light", "camera", "path", "paint", "info"}) {
        const ProgramResult result = run_neuvv({"stage", verb, "--help"});
        EXPECT_EQ(result.code, 0) << verb;
        const size_t examples = result.out.find("Examples");
        ASSERT_NE(examples, std::string::npos) << verb;
        EXPECT_NE(result.out.find(std::string("neuvv stage ") + verb, examples), std::string::npos) << verb;
    }
}

TEST_F(StageVerb, NamesDoNotCommandTheTerminal) {
    expect_done({"new", show});
    std::string text = read_text(show);
    const std::string name = "\"name\": \"key\"";
    ASSERT_NE(text.find(name), std::string::npos);
    text.replace(text.find(name), name.size(), R"("name": "\u001b]0;ah\u0007\u009b31mkey é")");
    write_text(show, text);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"info", show}, {"light", show, "2", "--intensity", "5"}}) {
        std::vector<std::string> all = {"stage"};
        all.insert(all.end(), words.begin(), words.end());
        const ProgramResult result = run_neuvv(all);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_NE(result.out.find(" ]0;ah   31mkey é"), std::string::npos) << result.out;
    }
}

TEST_F(StageVerb, AShowFromNothing) {
    expect_done({"new", show}, "show.gltf");
    expect_refused({"stage", "new", show}, 2, {"show.gltf", "already"});
    expect_done({"add", show, clip, "--name", "anna", "--at", "-1,0,0.5", "--time", "loop,speed:2"},
                "\"anna\" (node 3)");
    expect_done({"duplicate", show, "anna", "--count", "3", "--ring", "2", "--stagger", "2f"}, "3 more");
    expect_done(
        {"set", show, "anna 2", "--spin", "-45", "--opacity", "0.5", "--casts-shadow", "off", "--name", "berta"});
    expect_done({"set", show, "--duration", "6", "--ambient", "0.1,0.2,0.3", "--blend", "paper"});
    expect_done({"light", show, "--add", "--name", "rim", "--at", "-2,3,-2", "--aim", "0,1,0", "--color", "#ff0000"});
    expect_done({"light", show, "key", "--intensity", "80", "--cone", "15,25"});
    auto json = info();
    EXPECT_EQ(json["duration"], 6);
    EXPECT_EQ(json["ambient"], nlohmann::json::parse("[0.1,0.2,0.3]"));
    ASSERT_EQ(json["performers"].size(), 4u);
    EXPECT_EQ(json["clips"].size(), 1u);
    EXPECT_EQ(json["performers"][0]["position"][0], -1);
    EXPECT_EQ(json["performers"][1]["name"], "berta");
    EXPECT_EQ(json["performers"][1]["spin"], -45);
    EXPECT_EQ(json["performers"][1]["casts_shadow"], false);
    EXPECT_EQ(json["performers"][3]["time"], "loop,speed:2,offset:-1f") << "6 frames behind within 3.5";
    EXPECT_TRUE(json["performers"][3]["seconds"].is_null()) << "endless";
    EXPECT_EQ(info({"--at", "0.12"})["performers"][0]["frame"], 6);
    EXPECT_EQ(info({"--at", "99.12"}).at("performers").size(), 4u) << "performers loop";
    ASSERT_EQ(json["lights"].size(), 2u);
    EXPECT_EQ(json["lights"][0]["intensity"], nlohmann::json::parse("[80.0,80.0,80.0]"));
    EXPECT_EQ(json["lights"][1]["intensity"][1], 0);
    EXPECT_EQ(json["cameras"][0]["name"], "camera");
    expect_done({"remove", show, "berta"}, "removed \"berta\"");
    expect_done({"light", show, "rim", "--remove"});
    EXPECT_EQ(info()["performers"].size(), 3u);
    EXPECT_EQ(info()["lights"].size(), 1u);
    voctree::write_paint(file("red.nvpaint"), {voctree::painted_field(voctree::read_nvv(clip)), {}});
    expect_done({"paint", show, "anna", "--add", file("red.nvpaint"), "--name", "red", "--blend", "tint"});
    expect_done({"paint", show, "anna", "--layer", "0", "--opacity", "0.5"});
    EXPECT_EQ(info()["performers"][0]["paint_layers"], 1);
    const ProgramResult text = run_neuvv({"stage", "info", show});
    EXPECT_EQ(text.code, 0);
    for (const char* part :
         {"6 s at 25 fps", "3 performers", "anna", "loop,speed:2", "eva.nvv", "key", "spot", "45.0°"})
        EXPECT_NE(text.out.find(part), std::string::npos) << part << " not in: " << text.out;
    expect_done({"set", show, "anna", "--move", "1,0,0", "-o", file("other/copy.gltf")});
    EXPECT_EQ(stage::load_stage(file("other/copy.gltf")).clips.at(0).path, std::filesystem::canonical(clip));
}

// What other programs get of a stage's path and cameras, and what the program reads back.
TEST_F(StageVerb, CamerasGoToOtherProgramsAndBack) {
    expect_done({"new", show});
    expect_done({"camera", show, "--add", "--name", "left", "--at", "-3,1.6,2", "--aim", "0,1,0", "--angle", "30"});
    const auto exported = [&](const std::vector<std::string>& more, const std::string& said) {
        std::vector<std::string> all = {"export", show};
        all.insert(all.end(), more.begin(), more.end());
        all.emplace_back("--overwrite");
        const ProgramResult result = run_neuvv(all);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_NE(result.out.find(said), std::string::npos) << result.out;
    };
    exported({"--as", "camera", "--camera", "left", "-o", file("left.usda")}, "1 images of 1280x720");
    expect_done({"path", show, "--from", file("left.usda")});
    EXPECT_NEAR(stage::load_stage(show).settings.camera_path->keys.at(0).angle_y, glm::radians(30.0), 1e-6);
    expect_done({"path", show, "--key", "2", "--camera", "camera"});
    const stage::CameraPath path = stage::load_stage(show).settings.camera_path.value();
    for (const std::string name : {"nerfstudio", "instant-ngp"}) {
        exported({"--as", name, "-o", file("path.json"), "--fps", "10", "--size", "640x360"},
                 "21 images of 640x360, 10");
        expect_done({"path", show, "--from", file("path.json")});
        const stage::CameraPath back = stage::load_stage(show).settings.camera_path.value();
        ASSERT_EQ(back.keys.size(), 21u) << name;
        EXPECT_LT(glm::distance(back.keys[20].position, path.keys[1].position), 1e-6) << name;
    }
    exported({"--as", "camera", "-o", file("path.glb")}, "glTF has one angle of view");
    expect_done({"path", show, "--from", file("path.glb")});
    EXPECT_EQ(stage::load_stage(show).settings.camera_path->keys.size(), 51u) << "25 a second";
    expect_refused({"export", show, "--as", "camera", "-o", file("path.json")}, 2, {"path.json", ".usda or .glb"});
    expect_refused({"export", clip, "--as", "camera", "-o", file("path.usda")}, 2, {"eva.nvv", ".gltf"});
    expect_refused({"export", show, "--as", "camera", "--camera", "nobody", "-o", file("path.usda")}, 2, {"nobody"});
}

// Performers, cameras and lights of an exported layout are, at each time, where the stage has them.
TEST_F(StageVerb, LayoutsGoToOpenUsd) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna b", "--at", "-1,0,0.5"});
    expect_done({"set", show, "anna b", "--spin", "90"});
    expect_done({"set", show, "--duration", "2"});
    write_text(file("splats/anna b.usda"), "#usda 1.0\n");
    const ProgramResult run = run_neuvv(
        {"export", show, "--as", "layout", "-o", file("show.usda"), "--fps", "10", "--splats", file("splats")});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.out.find("1 performers, 1 lights, 1 cameras for 2 s"), std::string::npos) << run.out;
    const stage::Stage stage = stage::load_stage(show);
    const interchange::UsdLayer layer = interchange::read_usda(file("show.usda"));
    EXPECT_EQ(layer.number("endTimeCode", 0), 20);
    EXPECT_EQ(layer.number("timeCodesPerSecond", 0), 10);
    EXPECT_EQ(layer.number("metersPerUnit", 0), 1);
    EXPECT_EQ(layer.text("upAxis", ""), "Y");
    const std::vector<interchange::UsdPrim>& prims = layer.prims.at(0).children;
    ASSERT_EQ(prims.size(), 4u);
    EXPECT_EQ(prims[0].name, "anna_b");
    EXPECT_EQ(prims[0].metadata.at("references").texts.at(0), "./splats/anna b.usda");
    EXPECT_EQ(prims[1].metadata.at("references").texts.at(0), "./show.gltf");
    EXPECT_EQ(prims[2].type, "SphereLight");
    EXPECT_EQ(prims[3].type, "Camera");
    EXPECT_EQ(prims[2].attributes.at("inputs:intensity").value.numbers.at(0), 4 * 60);
    EXPECT_NEAR(prims[2].attributes.at("inputs:shaping:cone:angle").value.numbers.at(0), 36, 1e-3);
    for (const double code : {0.0, 3.0, 20.0}) {
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, code / 10);
        const auto expect_at = [&](const interchange::UsdPrim& prim, const glm::dmat4& world) {
            const glm::dmat4 written = interchange::usd_local_transform(prim, code, "show.usda");
            for (int i = 0; i < 4; ++i) EXPECT_LT(glm::distance(written[i], world[i]), 1e-6) << prim.name << code;
        };
        expect_at(prims[0], evaluated.performers[0].world_from_performer);
        expect_at(prims[2], evaluated.pose.world_from_node[evaluated.lights[0].node]);
        expect_at(prims[3], evaluated.cameras[0].world_from_camera);
        const auto frame = interchange::usd_value_at(prims[0].attributes.at("neuvv:frame"), code);
        EXPECT_NEAR(frame.numbers.at(0), static_cast<double>(evaluated.performers[0].frame), 1e-4);
    }
}

TEST_F(StageVerb, ExportedSplatsMayLieInAStage) {
    interchange::Splats splats;
    splats.splats.resize(3);
    interchange::write_splat_glb(file("splats.glb"), std::vector<interchange::Splats>{splats}, 25);
    const ProgramResult info_run = run_neuvv({"stage", "info", file("splats.glb")});
    EXPECT_EQ(info_run.code, 0) << info_run.err;
    EXPECT_NE(info_run.out.find("draws no points, lines or splats: mesh 0"), std::string::npos) << info_run.out;
}

// Sixteen lights shine and four cast shadows; `info` names those that do not.
TEST_F(StageVerb, LightsBeyondTheLimitsAreNamed) {
    stage::StageFile file = edit::new_stage(show);
    edit::LightEdit point;
    point.kind = "point";
    edit::add_light(file, "bulb", point, {});
    for (int i = 1; i <= 16; ++i) edit::add_light(file, "spot " + std::to_string(i), {}, {});
    stage::save_stage_file(file, show);
    const auto lights = info()["lights"];
    ASSERT_EQ(lights.size(), 18u);
    for (size_t i = 0; i < 18; ++i) {
        const bool spot = i != 1;
        const bool shadow = spot && i < 5;  // the light "key", and three more after the point light
        EXPECT_EQ(lights[i]["shines"], i < 16) << i;
        EXPECT_EQ(lights[i]["casts_shadow"], shadow) << i;
        EXPECT_EQ(lights[i]["limited"], spot && !shadow) << i;
    }
    const std::string text = run_neuvv({"stage", "info", show}).out;
    const auto line_of = [&](const std::string& name) {
        const size_t begin = text.find(name + " ");
        return text.substr(begin, text.find('\n', begin) - begin);
    };
    EXPECT_NE(line_of("key").find(", casts shadows"), std::string::npos) << text;
    EXPECT_NE(line_of("bulb").find(", no shadows"), std::string::npos) << text;
    EXPECT_NE(line_of("spot 3").find(", casts shadows"), std::string::npos) << text;
    EXPECT_NE(line_of("spot 4").find("casts no shadow: only the first 4 "), std::string::npos) << text;
    EXPECT_NE(line_of("spot 15").find("does not shine: only the first 16 "), std::string::npos) << text;
    expect_done({"set", show, "--shadows", "off"});
    EXPECT_EQ(info()["lights"][0]["casts_shadow"], false);
    EXPECT_EQ(info()["lights"][0]["limited"], false) << "the stage says so, not a limit";
}

TEST_F(StageVerb, CamerasAreAddedAndChanged) {
    expect_done({"new", show});
    expect_done({"camera", show, "--add", "--name", "camera", "--angle", "30", "--at", "0,1,3", "--aim", "0,1,0"},
                "\"camera 2\" (node 3), 30° high");
    expect_done({"camera", show, "camera 2", "--angle", "60", "--move", "1,0,0"}, "sees 60° high");
    const auto json = info();
    ASSERT_EQ(json["cameras"].size(), 2u);
    EXPECT_NEAR(json["cameras"][0]["degrees"].get<double>(), 45, 1e-9);
    EXPECT_NEAR(json["cameras"][1]["degrees"].get<double>(), 60, 1e-9);
    EXPECT_EQ(json["cameras"][1]["position"], nlohmann::json({1, 1, 3}));
    expect_refused({"stage", "camera", show}, 2, {"--add"});
    expect_refused({"stage", "camera", show, "camera"}, 2, {"nothing to change"});
    expect_refused({"stage", "camera", show, "floor", "--angle", "30"}, 2, {"floor", "no camera"});
    expect_refused({"stage", "camera", show, "camera", "--angle", "180"}, 2, {"--angle"});
}

TEST_F(StageVerb, ACameraPathIsMadeOfCameras) {
    expect_done({"new", show});
    expect_done({"camera", show, "--add", "--name", "left", "--at", "-3,1,2", "--aim", "0,1,0", "--angle", "30"});
    expect_refused({"stage", "path", show}, 2, {"nothing to change"});
    expect_refused({"stage", "path", show, "--cyclic", "on"}, 2, {"no camera path", "--key"});
    expect_done({"path", show, "--key", "1"}, "key at 1 s added");
    expect_done({"path", show, "--key", "3", "--camera", "left"}, "2 keys");
    EXPECT_EQ(info()["duration"], 3);
    expect_done({"path", show, "--move-key", "0", "--to", "0"}, "from 1 s to 0 s");
    expect_done({"path", show, "--cyclic", "on", "--duration", "5", "--interpolation", "linear"});
    const auto json = info()["camera_path"];
    EXPECT_EQ(json, nlohmann::json::parse(R"({"keys":2,"first":0,"last":3,"interpolation":"linear","cyclic":true,
                                              "duration":5})"));
    const std::string text = run_neuvv({"info", show}).out;
    EXPECT_NE(text.find("camera path: 2 keys from 0 s to 3 s, linear, back every 5 s"), std::string::npos) << text;
    const stage::CameraPath path = stage::load_stage(show).settings.camera_path.value();
    EXPECT_NEAR(path.keys[1].angle_y, glm::radians(30.0), 1e-12);
    EXPECT_LT(glm::length(path.keys[1].position - glm::dvec3(-3, 1, 2)), 1e-12);
    write_text(file("path.json"), R"({"camera_angle_y":0.5,"frames":[{"seconds":0.5,"transform_matrix":
        [[1,0,0,0],[0,1,0,1],[0,0,1,3],[0,0,0,1]]}]})");
    expect_done({"path", show, "--from", file("path.json")}, "camera path of 1 key");
    expect_refused({"stage", "path", show, "--remove-key", "1"}, 2, {"no key 1"});
    expect_refused({"stage", "path", show, "--key", "0", "--camera", "nobody"}, 2, {"nobody", "left"});
    expect_refused({"stage", "path", show, "--key", "0", "--remove"}, 2, {"--"});
    expect_refused({"stage", "path", show, "--move-key", "0"}, 2, {"--to"});
    expect_done({"path", show, "--remove"}, "no camera path");
    EXPECT_FALSE(info().contains("camera_path"));
}

TEST_F(StageVerb, NodesAreHiddenAndLocked) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    expect_done({"set", show, "anna", "--shown", "off", "--locked", "on"}, "hidden, and what hangs on it");
    expect_done({"set", show, "key", "--shown", "off"});
    auto json = info();
    EXPECT_EQ(json["performers"][0]["visible"], false);
    EXPECT_EQ(json["lights"].size(), 0u);
    EXPECT_EQ(json["hidden"], nlohmann::json({2, 3}));
    EXPECT_EQ(json["locked"], nlohmann::json({3}));
    const std::string text = run_neuvv({"info", show}).out;
    EXPECT_NE(text.find("hidden: key, anna\nlocked: anna\n"), std::string::npos) << text;
    expect_done({"set", show, "anna", "--shown", "on", "--locked", "off"}, "shown; \"anna\" (node 3): not locked");
    json = info();
    EXPECT_EQ(json["performers"][0]["visible"], true);
    EXPECT_EQ(json["locked"].size(), 0u);
}

// A stage of another program: an edit changes no bytes but its own.
TEST_F(StageVerb, AnotherProgramsBytesStay) {
    show = test::put_foreign_stage(folder.path).string();
    const std::string before = read_text(show);
    expect_done({"set", show, "Anna", "--opacity", "0.75", "--move", "0,1,0"});
    const std::string after = read_text(show);
    std::string expected = before;
    const auto replace = [&](const std::string& what, const std::string& with) {
        const size_t place = expected.find(what);
        ASSERT_NE(place, std::string::npos);
        expected.replace(place, what.size(), with);
    };
    replace("\"opacity\" : 0.50", "\"opacity\" : 0.75");
    const size_t end = after.find("\"translation\" : [0.0, 1.0, 0.0]");
    ASSERT_NE(end, std::string::npos) << after;
    replace("\"ACME_fog\" : { \"off\" : true } } }",
            "\"ACME_fog\" : { \"off\" : true } },\n\t\t  \"translation\" : [0.0, 1.0, 0.0] }");
    // The new member has the white space of one of its neighbours, so white space is not compared.
    const auto bare = [](std::string text) {
        std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\t'; });
        return text;
    };
    EXPECT_EQ(bare(after), bare(expected));
    const size_t node = before.find("{ \"name\" : \"Anna\""),
                 next = before.find("{ \"extensions\" : { \"KHR_lights_punctual\" : { \"light\" : 1");
    EXPECT_EQ(after.substr(0, node), before.substr(0, node));
    EXPECT_TRUE(after.ends_with(before.substr(next)));
    expect_done({"set", show, "Anna", "--opacity", "0.50", "--move", "0,0,0"});
    expect_done({"remove", show, "Camera"}, "ACME_fog");
    const std::string removed = read_text(show);
    for (const char* kept :
         {"\"by hand\":1e-3", "\"range\":1E+1", "[ 1.0, 2.0 ,3.0 ]", "\"later\" : 1e0", "[ 5.000, 1.0, 5.0 ]",
          "\"why\" : 1.0", "-0.70710678118654757, -0.0, 0.0", "\"nodes\" : [ 0, 1, 2 ]"})
        EXPECT_NE(removed.find(kept), std::string::npos) << kept << " not in " << removed;
}

TEST_F(StageVerb, EditsAtTheSameTimeAreAllKept) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    std::vector<std::thread> programs;
    for (const std::string name : {"berta", "clara", "dora"})
        programs.emplace_back([&, name] { expect_done({"add", show, clip, "--name", name}); });
    programs.emplace_back([&] { expect_done({"set", show, "anna", "--spin", "20"}); });
    programs.emplace_back([&] { expect_done({"light", show, "--add", "--name", "rim"}); });
    const std::string layer = file("red.nvpaint");
    for (const char* half : {"-9,-9,-9,0,9,9", "0,-9,-9,9,9,9"})
        programs.emplace_back([&, half] {
            const ProgramResult painted =
                run_neuvv({"paint", "region", show, layer, "--node", "anna", "--box", half, "--colour", "red"});
            EXPECT_EQ(painted.code, 0) << painted.err;
        });
    for (std::thread& program : programs) program.join();
    const auto json = info();
    ASSERT_EQ(json["performers"].size(), 4u);
    EXPECT_EQ(json["performers"][0]["spin"], 20);
    EXPECT_EQ(json["performers"][0]["paint"].size(), 1u);
    EXPECT_EQ(json["lights"].size(), 2u);
    const ProgramResult painted = run_neuvv({"paint", "info", clip, layer, "--json"});
    EXPECT_EQ(nlohmann::json::parse(painted.out)["leaves"], voctree::read_nvv(clip).leaf_count) << "both halves";
    for (const auto& entry : std::filesystem::directory_iterator(folder.path))
        EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path() << " stayed";
}

TEST_F(StageVerb, WhatCannotBeDoneIsOneLine) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    const std::string before = read_text(show);
    expect_refused({"stage"}, 2, {"neuvv stage --help"});
    expect_refused({"stage", "dance", show}, 2, {"neuvv stage --help"});
    expect_refused({"stage", "info", file("none.gltf")}, 2, {"none.gltf"});
    expect_refused({"stage", "add", show, file("none.nvv")}, 2, {"none.nvv"});
    expect_refused({"stage", "add", show, show}, 2, {"show.gltf"});
    expect_refused({"stage", "set", show, "berta", "--spin", "1"}, 2, {"berta", "anna"});
    expect_refused({"stage", "set", show, "anna"}, 2, {"nothing to change"});
    expect_refused({"stage", "set", show, "--spin", "1"}, 2, {"node"});
    expect_refused({"stage", "set", show, "anna", "--fps", "20"}, 2, {"stage"});
    expect_refused({"stage", "set", show, "anna", "--opacity", "nan"}, 2, {"--opacity"});
    expect_refused({"stage", "set", show, "anna", "--at", "1,2"}, 2, {"--at", "3 numbers"});
    expect_refused({"stage", "set", show, "anna", "--at", "nan,0,0"}, 2, {"--at"});
    expect_refused({"stage", "set", show, "anna", "--scale", "0"}, 2, {"anna", "flat"});
    expect_refused({"stage", "set", show, "anna", "--time", "loop,reverse"}, 2, {"endless"});
    expect_refused({"stage", "set", show, "anna", "--time", "swing"}, 2, {"--time", "swing", "ping-pong"});
    expect_refused({"stage", "set", show, "floor", "--spin", "3"}, 2, {"floor", "no performer"});
    expect_refused({"stage", "duplicate", show, "anna", "--count", "0", "--row", "1"}, 2, {"--count"});
    expect_refused({"stage", "duplicate", show, "anna", "--count", "99999999999", "--row", "1"}, 2, {"--count"});
    expect_refused({"stage", "duplicate", show, "anna", "--count", "3"}, 2, {"--row"});
    expect_refused({"stage", "duplicate", show, "anna", "--row", "1", "--ring", "1"}, 2, {"--r"});
    expect_refused({"stage", "duplicate", show, "anna", "--row", "1", "--stagger", "3"}, 2, {"3", "3f"});
    expect_refused({"stage", "light", show}, 2, {"--add"});
    expect_refused({"stage", "light", show, "anna", "--intensity", "3"}, 2, {"anna", "no light"});
    expect_refused({"stage", "paint", show, "anna", "--layer", "0", "--opacity", "1"}, 2, {"no paint layer 0"});
    expect_refused({"stage", "remove", show, "anna", "-o", file("x.glb")}, 2, {"x.glb", ".gltf"});
    expect_refused({"stage", "duplicate", show, "anna", "--ring", "0"}, 2, {"--ring"});
    expect_refused({"stage", "duplicate", show, "anna", "--fan", "0", "90"}, 2, {"--fan"});
    expect_refused({"stage", "set", show, "anna", "--time", "loop:0:100s"}, 2, {"--time", "2500", "7f"});
    expect_refused({"stage", "set", show, "anna", "--scale", "1e30"}, 2, {"--scale", "too large"});
    expect_refused({"stage", "light", show, "key", "--color", "redd"}, 2, {"--colour", "redd", "fuchsia"});
    expect_refused({"stage", "set", show, "--background", "redd"}, 2, {"--background"});
    expect_refused({"stage", "set", show, "--ambient", "clear"}, 2, {"--ambient", "no colour of light"});
    expect_refused({"stage", "new", file("show.txt")}, 2, {"show.txt", ".gltf or .glb"});
    expect_refused({"stage", "set", show, "anna", "--spin", "1", "-o", file("show.txt")}, 2, {"--output", "show.txt"});
    EXPECT_EQ(read_text(show), before);
    std::string twice = before;
    twice.replace(twice.find("\"floor\"", twice.find("\"nodes\": [\n")), 7, "\"anna\"");
    write_text(show, twice);
    expect_refused({"stage", "remove", show, "anna"}, 2, {"2 nodes", "choose by index: 0, 3"});
    expect_done({"remove", show, "3"});
}

TEST_F(StageVerb, MistypedVerbsAreToldWhatThereIs) {
    expect_refused({"stage", "ad", show}, 2,
                   {"there is no `neuvv stage ad`", "did you mean `add`?", "neuvv stage --help"});
    expect_refused({"stage"}, 2, {"`neuvv stage` needs a verb", "duplicate", "neuvv stage --help"});
    expect_refused({"dance"}, 2, {"there is no `neuvv dance`", "render", "`neuvv --help`"});
    expect_refused({"paint", "undo", clip, file("x.nvpaint")}, 2,
                   {"there is no `neuvv paint undo`", "restore", "neuvv paint --help"});
    expect_refused({"stage", "set", show, "--wobble"}, 2, {"--wobble", "neuvv stage set --help"});
    expect_refused({"stage", "light", show, "key", "--intensity", "x"}, 2, {"--intensity", "neuvv stage light --help"});
}

TEST_F(StageVerb, NamesThatAreTakenAreNumbered) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    expect_done({"set", show, "anna", "--name", "floor"}, "\"floor 2\", as there is a \"floor\" already");
    expect_done({"set", show, "floor 2", "--name", "floor 2"}, "named \"floor 2\"\n");
}

// A file of the wrong kind is recognised by its content, before anything is written.
TEST_F(StageVerb, FilesOfAnotherKindAreNamed) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    const std::string before = read_text(show), layer = file("red.nvpaint"), other = file("other.nvv");
    test::put_clip(other, 9);
    voctree::write_paint(layer, {voctree::painted_field(voctree::read_nvv(other)), {}});
    expect_refused({"stage", "add", show, layer}, 2, {"red.nvpaint", "is a layer of paint"});
    expect_refused({"stage", "set", show, "anna", "--clip", layer}, 2, {"is a layer of paint"});
    expect_refused({"stage", "info", clip}, 2, {"eva.nvv", "is a clip", "neuvv stage new"});
    expect_refused({"stage", "paint", show, "anna", "--add", layer}, 2, {"show.gltf", "anna", "eva.nvv", "9 frames"});
    expect_refused({"stage", "paint", show, "anna", "--add", clip}, 2, {"is a clip, not a layer of paint"});
    expect_refused({"stage", "set", show, "--environment", file("none.png")}, 2, {"none.png"});
    expect_refused({"stage", "set", show, "--environment", show}, 2, {"show.gltf"});
    EXPECT_EQ(read_text(show), before);
    write_text(file("x.txt"), "text");
    expect_refused({"render", file("x.txt"), "-o", file("x.png"), "--time", "0"}, 2,
                   {"x.txt", "neither a clip nor a stage"});
}

TEST_F(StageVerb, InfoIsOneForClipsAndStages) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna", "--turn", "0, 30, 0", "--scale", "2", "--casts-shadow", "off"},
                "turned by (0, 30, 0)°, scaled by 2, at (0, 0, 0)");
    expect_done({"set", show, "--shadows", "off", "--background", "red"}, "background (1, 0, 0), no shadows");
    expect_done({"light", show, "--add", "--kind", "point", "--colour", "lime", "--range", "3"},
                "point, colour (0, 1, 0), ends 3 m off");
    expect_done({"light", show, "key", "--cone", "15,25", "--turn", "0,10,0"},
                "full light up to 15°, none from 25°; \"key\"");
    const ProgramResult text = run_neuvv({"info", show}), same = run_neuvv({"stage", "info", show});
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_EQ(text.out, same.out);
    for (const char* part :
         {"turned by (0, 30, 0)°", "scaled by 2", "casts no shadows", "cone 15° to 25°", "60 cd", "colour (0, 1, 0)",
          "ends 3 m off", "background (1, 0, 0)", "blend exact, shadows off, falloff on"})
        EXPECT_NE(text.out.find(part), std::string::npos) << part << " not in: " << text.out;
    EXPECT_EQ(run_neuvv({"info", show, "--json"}).out, run_neuvv({"stage", "info", show, "--json"}).out);
    EXPECT_NEAR(info()["performers"][0]["turn"][1].get<double>(), 30, 1e-9);
    EXPECT_EQ(info()["lights"][1]["colour"][1], 1);
    expect_refused({"info", clip, "--memory"}, 2, {"--memory", "stages"});
}

// A performer whose .nvv is missing: the error names it, and the performer can be removed.
TEST_F(StageVerb, AMissingClipIsNamedAndCanBeRemoved) {
    expect_done({"new", show});
    expect_done({"add", show, clip, "--name", "anna"});
    std::filesystem::remove(clip);
    expect_refused({"stage", "info", show}, 2, {"\"anna\"", "eva.nvv"});
    expect_done({"remove", show, "anna"});
    expect_done({"info", show}, "0 performers");
}

TEST(StageOptions, VectorsAndColours) {
    EXPECT_EQ(tools::parse_vector("--at", "1,-2.5,1e-3"), glm::dvec3(1, -2.5, 1e-3));
    for (const char* text :
         {"", "1", "1,2", "1,2,3,4", "1,2,", ",1,2", "1,2,x", "1 2,3", "1,2 0,3", "nan,0,0", "1,2,3,"})
        expect_input_error([&] { tools::parse_vector("--at", text); }, {"--at", "3 numbers"});
    for (const char* text : {"inf,0,0", "1e99,0,0", "0,0,-1e999", "1,2e9,3"})
        expect_input_error([&] { tools::parse_vector("--at", text); }, {"--at", "too large"});
    EXPECT_EQ(tools::parse_vector("--at", " 1, 2 ,3"), glm::dvec3(1, 2, 3));
    EXPECT_EQ(tools::parse_vector("--at", "1e-999,0,0"), glm::dvec3(0));
    EXPECT_EQ(tools::parse_light_colour("--ambient", "0.25,2,0"), glm::dvec3(0.25, 2, 0));
    EXPECT_EQ(tools::parse_light_colour("--ambient", "white"), glm::dvec3(1));
    EXPECT_NEAR(tools::parse_light_colour("--ambient", "#bcbcbc").x, 0.5, 0.01) << "sRGB";
    expect_input_error([&] { tools::parse_light_colour("--ambient", "warm"); }, {"warm"});
}

}  // namespace
}  // namespace neuvv
