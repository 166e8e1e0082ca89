#include "stage/stage.h"
#include "stage/camera_path_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "stage/evaluated_stage.h"
#include "support/input_error.h"
#include "support/near.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;
using test::expect_near;

struct Stages : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path at(const std::string& name) const { return folder.path / name; }

    // The foreign stage with a change, as text or as JSON.
    stage::Stage changed(const std::string& what, const std::string& with) {
        test::put_foreign_stage(folder.path);
        std::string text = test::kForeignStage;
        const size_t offset = text.find(what);
        EXPECT_NE(offset, std::string::npos) << what;
        write_text(at("stage.gltf"), text.replace(offset, what.size(), with));
        return stage::load_stage(at("stage.gltf"));
    }
    void expect_refused(const std::string& what, const std::string& with, std::initializer_list<std::string> parts) {
        SCOPED_TRACE(with);
        expect_input_error([&] { changed(what, with); }, parts);
    }
};

TEST_F(Stages, AnotherProgramsStageIsRead) {
    const stage::Stage stage = stage::load_stage(test::put_foreign_stage(folder.path));
    EXPECT_EQ(stage.duration_s, 4);
    EXPECT_EQ(stage.fps, 30);
    expect_near(stage.ambient, {0.1, 0.1, 0.2}, 1e-6);
    ASSERT_EQ(stage.performers.size(), 1u);
    EXPECT_EQ(stage.performers[0].name, "Anna");
    EXPECT_EQ(stage::text_of(stage.performers[0].settings.time), "loop,offset:2f");
    ASSERT_EQ(stage.clips.size(), 1u);
    EXPECT_EQ(stage.clips[0].frames, 7u);
    expect_near(stage.clips[0].box_min, {-1, -0.25, -0.75}, 1e-6);
    ASSERT_EQ(stage.scene.lights.size(), 2u);
    EXPECT_EQ(stage.scene.lights[0].kind, stage::GltfLightKind::kSpot);
    EXPECT_EQ(stage.scene.lights[0].range_m, 10);
    EXPECT_EQ(stage.scene.lights[1].kind, stage::GltfLightKind::kDirectional);
    EXPECT_EQ(stage.scene.meshes[0].primitives[0].uvs.size(), 3u);
    EXPECT_EQ(stage.scene.images[0]->pixels.width, 1u);
}

TEST_F(Stages, AtAnInstantEverythingIsInWorldSpace) {
    const stage::Stage stage = stage::load_stage(test::put_foreign_stage(folder.path));
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, 1);
    ASSERT_EQ(evaluated.performers.size(), 1u);
    const stage::EvaluatedPerformer& anna = evaluated.performers[0];
    // 25 frames of stage time, 2 frames late, in a loop of 7.
    EXPECT_EQ(anna.frame, 23 % 7);
    EXPECT_EQ(anna.opacity, 0.5f);
    // Turned by 90° about its +Y, then by 45° about z, then stretched along x, then moved.
    const auto stood = [](glm::dvec3 p) {
        p = {p.z, p.y, -p.x};
        const double h = std::sqrt(0.5);
        p = {h * (p.x - p.y), h * (p.x + p.y), p.z};
        return glm::dvec3(2 * p.x + 1, p.y, p.z);
    };
    for (const glm::dvec3 p : {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(1, 2, 3)})
        expect_near(glm::dvec3(anna.world_from_performer * glm::dvec4(p, 1)), stood(p), 1e-6);
    ASSERT_EQ(evaluated.lights.size(), 2u);
    expect_near(evaluated.lights[0].position, {0, 4, 0}, 1e-6);
    expect_near(evaluated.lights[0].direction, {0, -1, 0}, 1e-6);
    expect_near(evaluated.lights[0].intensity, 54.35141306588226 * glm::dvec3(1, 0.5, 0.25), 1e-6);
    EXPECT_NEAR(evaluated.lights[0].cos_inner, std::cos(0.3), 1e-12);
    EXPECT_NEAR(evaluated.lights[0].cos_outer, std::cos(0.6), 1e-12);
    expect_near(evaluated.lights[1].direction, {0, 0, -1}, 1e-6);
    const stage::Camera camera = stage::camera_of(stage, "Camera", evaluated, 160, 80);
    expect_near(glm::dvec3(camera.world_from_camera[3]), {1, 1.5, 4}, 1e-6);  // the middle of its movement
    EXPECT_NEAR(camera.fy, 40 / std::tan(0.4), 1e-9);
    EXPECT_EQ(camera.fx, camera.fy);
    EXPECT_EQ(camera.cx, 80);
    expect_near(glm::dvec3(stage::camera_of(stage, "0", stage::stage_at(stage, 9), 8, 8).world_from_camera[3]),
                {2, 1.5, 4}, 1e-6);
    expect_near(glm::dvec3(stage::camera_of(stage, "", stage::stage_at(stage, 0), 8, 8).world_from_camera[3]),
                {0, 1.5, 4}, 1e-6);
    expect_input_error([&] { stage::camera_of(stage, "Lens2", evaluated, 8, 8); }, {"Lens2", "0 \"Camera\""});
}

TEST_F(Stages, APlainSceneIsAStage) {
    write_text(at("plain.gltf"), R"({"asset":{"version":"2.0"},"nodes":[{"name":"a"}]})");
    const stage::Stage stage = stage::load_stage(at("plain.gltf"));
    EXPECT_EQ(stage.duration_s, 0);
    EXPECT_EQ(stage.fps, 25);
    expect_near(stage.ambient, {1, 1, 1}, 1e-6);
    EXPECT_TRUE(stage.settings.shadows && stage.settings.falloff);
    EXPECT_EQ(stage.settings.blend, stage::StageBlend::kExact);
    EXPECT_TRUE(stage::stage_at(stage, 3).performers.empty());
    expect_input_error([&] { stage::camera_of(stage, "", stage::stage_at(stage, 0), 8, 8); }, {"none"});
}

TEST_F(Stages, APlenoctreeIsAClipOfOneFrame) {
    std::filesystem::copy(NEUVV_SOURCE_DIR "/tests/fuzz/corpus/plenoctree/tiny/scene.npz", at("tree.npz"));
    test::put_foreign_stage(folder.path);
    std::string text = test::kForeignStage;
    text.replace(text.find("anna.nvv"), 8, "tree.npz");
    text.replace(text.find("\"time\""), 6, "\"when\"");  // of a clip of more frames
    write_text(at("stage.gltf"), text);
    const stage::Stage stage = stage::load_stage(at("stage.gltf"));
    ASSERT_EQ(stage.clips.size(), 1u);
    EXPECT_EQ(stage.clips[0].frames, 1u);
    EXPECT_EQ(stage.clips[0].fps, 25);
    EXPECT_EQ(stage.clips[0].box_min, glm::dvec3(-1));
    EXPECT_EQ(stage.clips[0].box_size, glm::dvec3(2));
}

TEST_F(Stages, OneClipForAllThatPlayIt) {
    test::put_clip(at("clips/a.nvv"), 50, 50);
    test::put_clip(at("clips/b.nvv"), 10, 25);
    const char* const uris[] = {"../clips/a.nvv", "../clips/b.nvv", "../clips/../clips/a.nvv"};
    ordered_json json = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", {0, 1, 2}}}}}};
    for (const char* uri : uris) json["nodes"].push_back({{"extensions", {{"NEUVV_performer", {{"uri", uri}}}}}});
    json["nodes"].push_back({{"extensions", {{"NEUVV_performer", {{"uri", "missing, but in no scene"}}}}}});
    write_text(at("stage/s.gltf"), json.dump());
    const stage::Stage stage = stage::load_stage(at("stage/s.gltf"));
    ASSERT_EQ(stage.clips.size(), 2u);
    EXPECT_TRUE(stage.clips[0].path.is_absolute());
    ASSERT_EQ(stage.performers.size(), 3u);
    EXPECT_EQ(stage.performers[2].clip, 0u);
    EXPECT_EQ(stage.performers[1].name, "node 1");
    EXPECT_EQ(stage.duration_s, 1) << "50 frames of 50 fps";
    const auto lasts = [&](const char* time) {
        json["nodes"][2]["extensions"]["NEUVV_performer"]["time"] =
            stage::json_of(stage::parse_time_map(time, "test", ""));
        write_text(at("stage/s.gltf"), json.dump());
        return stage::load_stage(at("stage/s.gltf")).duration_s;
    };
    EXPECT_EQ(lasts("offset:1.5s"), 2.5) << "to the last one's end";
    EXPECT_EQ(lasts("offset:-0.5s"), 1);
    EXPECT_EQ(lasts("loop,offset:3s"), 1) << "endless: as long as its clip";
    EXPECT_EQ(stage.fps, 50);
    EXPECT_EQ(stage::stage_at(stage, 0.5).performers[0].frame, 25);
    EXPECT_EQ(stage::stage_at(stage, 0.5).performers[1].frame, 9);
}

TEST_F(Stages, CamerasOfScaledNodesAreRigid) {
    const stage::Stage stage =
        changed(R"("scale" : [ 2, 1, 1 ], "translation" : [ 1.0, 0, 0 ])", R"("scale" : [ -2, 3, 0.1 ])");
    for (const stage::EvaluatedLight& light : stage::stage_at(stage, 0).lights)
        EXPECT_NEAR(glm::length(light.direction), 1, 1e-12);
    const stage::Stage flat = changed(R"("translation" : [ 0, 1.50, 4 ])", R"("scale" : [ 0, 0, 0 ])");
    const stage::Camera camera = stage::camera_of(flat, "Camera", stage::stage_at(flat, 0), 8, 8);
    const glm::dmat3 turn(camera.world_from_camera);
    EXPECT_NEAR(glm::determinant(turn), 1, 1e-9);
    expect_near(turn * glm::transpose(turn) * glm::dvec3(1, 2, 3), {1, 2, 3}, 1e-6);
}

// KHR_node_visibility: a node hides everything below it except cameras.
TEST_F(Stages, HiddenNodesHideWhatHangsOnThem) {
    const std::string hidden = R"("extensions":{"KHR_node_visibility":{"visible":false}},)";
    const stage::Stage pivot = changed(R"("name" : "Pivot",)", hidden + R"("name" : "Pivot",)");
    EXPECT_FALSE(stage::stage_at(pivot, 0).performers.at(0).visible);
    ASSERT_EQ(stage::stage_at(pivot, 0).lights.size(), 1u);
    EXPECT_EQ(stage::stage_at(pivot, 0).lights[0].node, 2u);
    EXPECT_TRUE(pivot.scene.nodes[0].draws_mesh());
    const stage::Stage floor = changed(R"("mesh" : 0, "name" : "Floor",)", hidden + R"("mesh" : 0, "name" : "Floor",)");
    EXPECT_FALSE(floor.scene.nodes[0].draws_mesh());
    EXPECT_EQ(floor.scene.nodes[0].mesh, 0);
    EXPECT_TRUE(stage::stage_at(floor, 0).performers.at(0).visible);
    expect_input_error([&] { stage::bounds_over(floor.scene, stage::kNoAnimation, {0}); }, {"draw"});
    const stage::Stage camera =
        changed(R"("camera" : 0, "name" : "Camera",)", hidden + R"("camera" : 0, "name" : "Camera",)");
    EXPECT_EQ(stage::stage_at(camera, 0).cameras.size(), 1u);
    expect_refused(R"("name" : "Pivot",)", R"("extensions":{"KHR_node_visibility":{"visible":0}},"name":"Pivot",)",
                   {"/nodes/3/extensions/KHR_node_visibility/visible"});
    EXPECT_NO_THROW(changed(R"("extensionsRequired" : [ )", R"("extensionsRequired" : [ "KHR_node_visibility", )"));
}

TEST_F(Stages, OrthographicCamerasAreNamedAndNotDrawn) {
    const stage::Stage stage =
        changed(R"("type" : "perspective",
		"perspective" : { "aspectRatio" : 1.7777777777777777, "yfov" : 0.8, "zfar" : 1000, "znear" : 0.10000000149011612 })",
                R"("type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":0})");
    EXPECT_TRUE(stage::stage_at(stage, 0).cameras.at(0).orthographic);
    expect_input_error([&] { stage::camera_of(stage, "Camera", stage::stage_at(stage, 0), 8, 8); },
                       {"Camera", "orthographic"});
    expect_input_error([&] { stage::camera_of(stage, "", stage::stage_at(stage, 0), 8, 8); }, {"perspective"});
    expect_input_error([&] { stage::camera_of(stage, "nobody", stage::stage_at(stage, 0), 8, 8); },
                       {"none that is perspective"});
}

TEST_F(Stages, HostileOnesAreRefusedInALine) {
    const std::string transform = R"("scale" : [ 2, 1, 1 ], "translation" : [ 1.0, 0, 0 ])";
    expect_refused(transform, R"("scale":[0,1,1])", {"Anna", "flat", "/nodes/4"});
    expect_refused(transform, R"("scale":[1e300,1,1])", {"/nodes/3/scale", "large"});
    expect_refused(transform, R"("scale":[1e11,1e11,1e11])", {"Anna"});
    expect_refused(transform, R"("translation":[1e11,0,0])", {"Anna"});
    expect_refused(transform, R"("translation":[NaN,0,0])", {"JSON"});
    expect_refused(R"("children" : [ 4, 5 ])", R"("children":[3])", {"/nodes/3", "ancestor"});
    expect_refused(R"("children" : [ 4, 5 ])", R"("children":[4,99])", {"/nodes/3/children", "99"});
    expect_refused("\"KHR_lights_punctual\" ],", "\"KHR_lights_punctual\", \"ACME_fog\" ],",
                   {"ACME_fog", "not supported"});
    expect_refused("\"KHR_lights_punctual\" ],", "\"KHR_lights_punctual\", \"KHR_draco_mesh_compression\" ],",
                   {"KHR_draco", "without compression"});
    expect_refused("\"version\" : \"2.0\"", "\"version\" : \"1.0\"", {"/asset/version", "glTF 1.0", "2.0"});
    expect_refused("\"version\" : \"2.0\"", "\"version\" : \"2.1\", \"minVersion\":3", {"/asset/minVersion", "3"});
    expect_refused("stage%20data.bin", "gone.bin", {"/buffers/0/uri", "gone.bin", "beside"});
    expect_refused("\"byteLength\" : 128", "\"byteLength\":129", {"/buffers/0/uri", "128 bytes of 129"});
    expect_refused("\"anna.nvv\"", "\"berta.nvv\"", {"stage.gltf", "\"Anna\"", "berta.nvv"});
    expect_refused("\"anna.nvv\"", "\"stage.gltf\"", {"\"Anna\"", "stage.gltf"});
    expect_refused("\"anna.nvv\"", "\"/anna.nvv\"", {"/nodes/4/extensions/NEUVV_performer/uri", "relative"});
    expect_refused("\"anna.nvv\"", "\"ftp://x/anna.nvs\"", {"relative"});
    expect_refused("\"anna.nvv\"", "7", {"/nodes/4/extensions/NEUVV_performer/uri", "string"});
    expect_refused("\"uri\" : \"anna.nvv\", ", "", {"/nodes/4/extensions/NEUVV_performer", "uri"});
    expect_refused("\"spin\" : 90.0", "\"spin\":\"fast\"", {"NEUVV_performer/spin"});
    expect_refused("\"opacity\" : 0.50", "\"opacity\":1.5", {"NEUVV_performer/opacity", "0 to 1"});
    expect_refused("\"opacity\" : 0.50", "\"visible\":1", {"NEUVV_performer/visible"});
    expect_refused("\"opacity\" : 0.50", "\"castsShadow\":null", {"NEUVV_performer/castsShadow"});
    expect_refused("\"opacity\" : 0.50", "\"receivesShadow\":[]", {"NEUVV_performer/receivesShadow"});
    expect_refused("\"opacity\" : 0.50", "\"skeleton\":{}", {"NEUVV_performer/skeleton", "uri"});
    expect_refused("\"opacity\" : 0.50", "\"skeleton\":\"a.glb\"", {"NEUVV_performer/skeleton", "object"});
    expect_refused("\"opacity\" : 0.50", "\"skeleton\":{\"uri\":\"/a.glb\"}", {"NEUVV_performer/skeleton", "relative"});
    expect_refused("\"opacity\" : 0.50", "\"paint\":{}", {"NEUVV_performer/paint"});
    expect_refused("\"opacity\" : 0.50", "\"paint\":[{\"uri\":\"a\",\"blend\":\"add\"}]",
                   {"paint/0/blend", "recolour"});
    expect_refused("\"opacity\" : 0.50", "\"paint\":[{\"uri\":\"../../../a:b\"}]", {"paint", "relative"});
    expect_refused("\"operator\" : \"loop\"", "\"operator\":\"lop\"", {"time/0/operator", "lop"});
    expect_refused("\"by\" : \"2f\"", "\"by\":2", {"time/1/by"});
    expect_refused("\"duration\" : 4.0", "\"duration\":-1", {"/scenes/0/extensions/NEUVV_stage/duration"});
    expect_refused("\"fps\" : 30.0", "\"fps\":0", {"NEUVV_stage/fps"});
    expect_refused("\"fps\" : 30.0", "\"blend\":\"nice\"", {"NEUVV_stage/blend", "exact, paper"});
    expect_refused("\"fps\" : 30.0", "\"background\":[0,0]", {"NEUVV_stage/background"});
    expect_refused("\"fps\" : 30.0", "\"background\":[0,0,-1]", {"NEUVV_stage/background"});
    expect_refused("\"fps\" : 30.0", "\"environment\":\"sky.png\"", {"NEUVV_stage/environment", "object"});
    expect_refused("\"fps\" : 30.0", "\"environment\":{}", {"NEUVV_stage/environment", "uri"});
    expect_refused("\"fps\" : 30.0", "\"shadows\":\"yes\"", {"NEUVV_stage/shadows"});
    expect_refused("\"fps\" : 30.0", "\"falloff\":0", {"NEUVV_stage/falloff"});
    expect_refused("{ \"NEUVV_stage\" : {", "{ \"NEUVV_stage\" : 5, \"x\" : {", {"NEUVV_stage", "object"});
    expect_refused("\"light\" : 1", "\"light\":2", {"/nodes/5", "light"});
    expect_refused("\"light\" : 1", "\"light\":-1", {"/nodes/5", "light"});
    expect_refused("\"light\" : 1", "\"light\":\"1\"", {"/nodes/5", "light"});
    expect_refused("\"range\":1E+1", "\"range\":\"far\"", {"lights/0/range"});
    expect_refused("\"intensity\" : 3", "\"intensity\":-3", {"lights/1/intensity"});
    expect_refused("\"intensity\" : 3", "\"color\":[1,2]", {"lights/1/color"});
    expect_refused("\"directional\"", "\"laser\"", {"lights/1/type"});
    expect_refused("\"innerConeAngle\" : 0.3", "\"innerConeAngle\":0.7", {"lights/0/spot", "innerConeAngle"});
    expect_refused("\"outerConeAngle\" : 0.60", "\"outerConeAngle\":2", {"outerConeAngle"});
    expect_refused("\"scene\" : 0", "\"scene\":true", {"/scene", "index"});
    expect_refused("\"scene\" : 0", "\"scene\":7", {"/scene", "7"});
    expect_refused("\"camera\" : 0", "\"camera\":1", {"/nodes/1/camera"});
    expect_refused("\"camera\" : 0", "\"camera\":\"a\"", {"/nodes/1/camera"});
    expect_refused("\"yfov\" : 0.8", "\"yfov\":4", {"/cameras/0/perspective/yfov"});
    expect_refused("\"yfov\" : 0.8", "\"yfov\":\"wide\"", {"yfov"});
    expect_refused("\"unit\" : \"m\"", "\"unit\":" + std::string(5000, '['), {"deeper"});
    EXPECT_NO_THROW(changed("\"opacity\" : 0.50", "\"paint\":[{\"uri\":\"later.nvpaint\",\"who\":1}]"));
}

TEST_F(Stages, HostileCameraPathsAreRefused) {
    const std::string key = R"({"time":1,"position":[0,1,2],"rotation":[0,0,0,1],"yfov":0.5})",
                      later = R"({"time":2,"position":[0,1,2],"rotation":[0,0,0,1],"yfov":0.5})";
    const auto path = [](const std::string& members) { return "\"fps\":30,\"cameraPath\":{" + members + "}"; };
    const auto refused = [&](const std::string& members, std::initializer_list<std::string> parts) {
        expect_refused("\"fps\" : 30.0", path(members), parts);
    };
    EXPECT_EQ(changed("\"fps\" : 30.0", path("\"keys\":[" + key + "," + later + "]")).settings.camera_path->duration_s,
              2);
    refused("", {"cameraPath/keys"});
    refused("\"keys\":[]", {"cameraPath/keys"});
    refused("\"keys\":[" + key + "," + key + "]", {"cameraPath/keys/1/time", "after"});
    refused("\"keys\":[" + key + "],\"duration\":0.5", {"cameraPath/duration"});
    refused("\"keys\":[" + key + "," + later + "],\"cyclic\":true", {"cameraPath/duration", "come back"});
    refused("\"keys\":[" + key + "],\"interpolation\":\"spline\"", {"cameraPath/interpolation", "smooth"});
    const auto refused_key = [&](const std::string& what, const std::string& with,
                                 std::initializer_list<std::string> parts) {
        std::string bad = key;
        refused("\"keys\":[" + bad.replace(bad.find(what), what.size(), with) + "]", parts);
    };
    refused_key("\"time\":1,", "", {"keys/0", "time"});
    refused_key("0,1,2", "0,1", {"keys/0/position"});
    refused_key("0,1,2", "0,1e10,2", {"keys/0/position"});
    refused_key("0,0,0,1", "0,0,0,0", {"keys/0/rotation"});
    refused_key("0,0,0,1", "0,0,0,\"1\"", {"keys/0/rotation"});
    refused_key("0.5", "3.15", {"keys/0/yfov"});
}

// While an animation makes a performer's transform flat, the performer is invisible and the image is still drawn.
TEST_F(Stages, FlatWhileAnimatedIsInvisible) {
    const stage::Stage stage =
        changed(R"("target" : { "node" : 1, "path" : "translation" })", R"("target":{"node":4,"path":"scale"})");
    EXPECT_FALSE(stage::stage_at(stage, 0).performers.at(0).visible) << "from (0, 1.5, 4) to (2, 1.5, 4)";
    EXPECT_TRUE(stage::stage_at(stage, 0.5).performers.at(0).visible);
}

// Schema and reader must know the same members, and the reader must refuse what violates the schema's bounds.
void expect_members(const ordered_json& schema, const ordered_json& written, const std::string& what) {
    std::set<std::string> in_schema, in_file;
    for (const auto& [name, member] : schema["properties"].items()) in_schema.insert(name);
    for (const auto& [name, member] : written.items()) in_file.insert(name);
    EXPECT_EQ(in_schema, in_file) << what;
}

ordered_json schema_of(const char* name) {
    return ordered_json::parse(read_text(std::filesystem::path(NEUVV_SOURCE_DIR) / "engine/stage" / name));
}

TEST(StageSchema, PerformerHoldsWhatIsWritten) {
    stage::PerformerSettings settings;
    settings.uri = "a.nvv";
    settings.time = stage::parse_time_map("offset:1s,speed:2,pause:1s:2s,clip:0s:1s,jump:1f:2f", "", "");
    settings.spin_deg_per_s = 9;
    settings.opacity = 0.5;
    settings.visible = settings.casts_shadow = settings.receives_shadow = false;
    settings.skeleton_uri = "a.skeleton.glb";
    settings.sound = stage::PerformerSound{"a.wav", -3};
    settings.paint = {{"p.nvpaint", "red", false, 0.25, stage::PaintBlend::kTint}};
    const ordered_json json = stage::json_of(settings), schema = schema_of("NEUVV_performer.schema.json");
    expect_members(schema, json, "performer");
    expect_members(schema["properties"]["skeleton"], json["skeleton"], "skeleton");
    expect_members(schema["properties"]["sound"], json["sound"], "sound");
    expect_members(schema["$defs"]["layer"], json["paint"][0], "layer");
    EXPECT_EQ(schema["$defs"]["layer"]["properties"]["blend"]["enum"], ordered_json(stage::kPaintBlendNames));
    ordered_json operators = ordered_json::object();
    for (const ordered_json& op : json["time"]) operators.update(op);
    expect_members(schema["$defs"]["operator"], operators, "operator");
    for (const ordered_json& name : schema["$defs"]["operator"]["properties"]["operator"]["enum"])
        EXPECT_NO_THROW(stage::parse_time_map(
            name == "reverse" || name == "hold" || name == "loop" || name == "ping-pong" ? name.get<std::string>()
            : name == "speed"                                                            ? "speed:1"
            : name == "offset" || name == "freeze" ? name.get<std::string>() + ":1s"
                                                   : name.get<std::string>() + ":1s:2s",
            "", ""));
    const stage::PerformerSettings back = stage::performer_settings_of(json, "f", "p");
    EXPECT_EQ(stage::json_of(back), json);
    EXPECT_EQ(stage::json_of(stage::PerformerSettings{.uri = "a"}).size(), 1u) << "defaults are not written";
}

TEST(StageSchema, StageHoldsWhatIsWritten) {
    stage::StageSettings settings;
    settings.duration_s = 3;
    settings.fps = 24;
    settings.background = {0.1, 0.2, 0.3};
    settings.environment = stage::StageEnvironment{"sky.png", 2, 90};
    settings.ambient = glm::dvec3(0.5);
    settings.blend = stage::StageBlend::kPaper;
    settings.shadows = settings.falloff = false;
    settings.camera_path = stage::CameraPath{{{}, {}}, stage::Interpolation::kLinear, true, 2};
    settings.camera_path->keys[1].time_s = 1;
    const ordered_json json = stage::json_of(settings), schema = schema_of("NEUVV_stage.schema.json");
    expect_members(schema, json, "stage");
    expect_members(schema["properties"]["environment"], json["environment"], "environment");
    expect_members(schema["properties"]["cameraPath"], json["cameraPath"], "path");
    expect_members(schema["$defs"]["key"], json["cameraPath"]["keys"][1], "key");
    EXPECT_EQ(schema["properties"]["cameraPath"]["properties"]["interpolation"]["enum"],
              ordered_json(stage::kInterpolationNames));
    EXPECT_EQ(schema["$defs"]["key"]["required"].size(), 4u);
    EXPECT_EQ(schema["properties"]["blend"]["enum"], ordered_json(stage::kStageBlendNames));
    EXPECT_EQ(stage::json_of(stage::stage_settings_of(json, "f", "p")), json);
    EXPECT_TRUE(stage::json_of(stage::StageSettings()).empty());
}

// Every bound of a schema is the reader's: a value just inside is read, one just outside is refused.
TEST(StageSchema, BoundsAreTheReaders) {
    const auto each = [](const ordered_json& properties, const ordered_json& sound, const auto& read) {
        for (const auto& [name, member] : properties.items()) {
            for (const char* bound : {"minimum", "maximum"}) {
                if (!member.contains(bound)) continue;
                ordered_json json = sound;
                const double value = member[bound].template get<double>(),
                             past = std::max(1e-3, std::abs(value) * 1e-3);
                json[name] = value;
                EXPECT_NO_THROW(read(json)) << name;
                json[name] = bound == std::string("minimum") ? value - past : value + past;
                EXPECT_THROW(read(json), InputError) << name << ' ' << bound;
            }
            ordered_json wrong = sound;
            wrong[name] =
                member.contains("type") && member["type"] == "string" ? ordered_json(1) : ordered_json("wrong");
            EXPECT_THROW(read(wrong), InputError) << name << " of a wrong type";
        }
    };
    const ordered_json performer = {{"uri", "a"}}, schema = schema_of("NEUVV_performer.schema.json");
    each(schema["properties"], performer,
         [](const ordered_json& json) { stage::performer_settings_of(json, "f", "p"); });
    each(schema["properties"]["sound"]["properties"], performer, [&](const ordered_json& json) {
        stage::performer_settings_of({{"uri", "a"}, {"sound", json}}, "f", "p");
    });
    each(schema["$defs"]["layer"]["properties"], performer,
         [](const ordered_json& json) { stage::paint_layer_of(json, "f", "p"); });
    const ordered_json stage = schema_of("NEUVV_stage.schema.json");
    each(stage["properties"], ordered_json::object(),
         [](const ordered_json& json) { stage::stage_settings_of(json, "f", "p"); });
    const ordered_json path = stage::json_of(stage::CameraPath{{{}}, {}, false, 0});
    each(stage["properties"]["cameraPath"]["properties"], path,
         [](const ordered_json& json) { stage::camera_path_of(json, "f", "p"); });
    each(stage["$defs"]["key"]["properties"], path["keys"][0], [](const ordered_json& json) {
        stage::camera_path_of({{"keys", ordered_json::array({json})}, {"duration", 86400}}, "f", "p");
    });
}

}  // namespace
}  // namespace neuvv
