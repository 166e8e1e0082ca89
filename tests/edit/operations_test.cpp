// Operations on a stage's document: performers, lights, paint, settings.
#include <gtest/gtest.h>

#include <cmath>

#include "edit/edits.h"
#include "edit/operations.h"
#include "stage/evaluated_stage.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "support/near.h"
#include "tests/stage/stage_files.h"

namespace neuvv::edits_test {
namespace {

TEST_F(Edits, ANewStageIsLitAndSeen) {
    for (const char* name : {"new.gltf", "new.glb"}) {
        stage::StageFile made = edit::new_stage(at(name));
        stage::save_stage_file(made, at(name));
        const stage::Stage stage = stage::load_stage(at(name));
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
        ASSERT_EQ(evaluated.lights.size(), 1u);
        const glm::dvec3 to_centre = glm::dvec3(0, 1, 0) - evaluated.lights[0].position;
        expect_near(evaluated.lights[0].direction, glm::normalize(to_centre), 1e-5);
        const stage::Camera camera = stage::camera_of(stage, "camera", evaluated, 64, 64);
        expect_near(front(camera.world_from_camera),
                    glm::normalize(position(camera.world_from_camera) - glm::dvec3(0, 1, 0)), 1e-5);
        ASSERT_EQ(stage.scene.meshes.size(), 1u);
        const stage::GltfPrimitive& floor = stage.scene.meshes[0].primitives[0];
        const glm::vec3 a = floor.positions[floor.indices[0]], b = floor.positions[floor.indices[1]],
                        c = floor.positions[floor.indices[2]];
        expect_near(glm::normalize(glm::cross(b - a, c - a)), {0, 1, 0}, 1e-5);
        expect_near(stage.ambient, glm::dvec3(0.3), 1e-5);
    }
}

// The floor of a stage that is made for a clip lies under the clip's leaves, is as large as they need, and the light
// shines on them from above.
TEST_F(Edits, AStageForAClipHasALitFloorUnderIt) {
    for (const double size_m : {0.02, 1.8, 300.0}) {
        const glm::dvec3 low(3, -0.5 * size_m, -1), high = low + size_m * glm::dvec3(0.4, 1, 0.3);
        stage::StageFile made = edit::stage_for_clip(at("clip.gltf"), low, high);
        stage::save_stage_file(made, at("clip.gltf"));
        const stage::Stage stage = stage::load_stage(at("clip.gltf"));
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
        EXPECT_TRUE(evaluated.cameras.empty()) << "the eye is where all of it is seen";
        ASSERT_EQ(stage.scene.meshes.size(), 1u);
        glm::dvec3 floor_low(INFINITY), floor_high(-INFINITY);
        for (const glm::vec3& at : stage.scene.meshes[0].primitives[0].positions) {
            const glm::dvec3 world = evaluated.pose.world_from_node[0] * glm::dvec4(at, 1);
            floor_low = glm::min(floor_low, world);
            floor_high = glm::max(floor_high, world);
        }
        EXPECT_NEAR(floor_low.y, low.y, 1e-5 * size_m);
        EXPECT_NEAR(floor_high.y, low.y, 1e-5 * size_m);
        for (const int axis : {0, 2}) {
            EXPECT_LT(floor_low[axis], low[axis] - size_m);
            EXPECT_GT(floor_high[axis], high[axis] + size_m);
            EXPECT_LT(floor_high[axis] - floor_low[axis], 60 * size_m);
        }
        ASSERT_EQ(evaluated.lights.size(), 1u);
        EXPECT_GT(evaluated.lights[0].position.y, high.y);
        expect_near(evaluated.lights[0].direction, glm::normalize(0.5 * (low + high) - evaluated.lights[0].position),
                    1e-5);
    }
}

TEST_F(Edits, PerformersAreAddedPlacedAndSet) {
    test::put_clip(at("clips/berta k.nvv"));
    edit::PerformerEdit edit;
    edit.clip = at("clips/berta k.nvv");
    edit.time = stage::parse_time_map("loop,speed:2", "", "");
    edit::Placement placement;
    placement.at = glm::dvec3(1, 0, -1);
    placement.turn_deg = glm::dvec3(0, 90, 0);
    placement.scale = glm::dvec3(2);
    const std::string said = edit::add_performer(file, "", edit, placement);
    EXPECT_NE(said.find("\"berta k\" (node 6)"), std::string::npos) << said;
    EXPECT_EQ(node("berta k")["extensions"]["NEUVV_performer"]["uri"], "clips/berta%20k.nvv");
    EXPECT_EQ(stage().performers.size(), 2u);
    const glm::dmat4 stands = performer("berta k").world_from_performer;
    expect_near(position(stands), {1, 0, -1}, 1e-5);
    expect_near(glm::dvec3(stands * glm::dvec4(0, 0, 1, 1)), {3, 0, -1}, 1e-5);
    EXPECT_EQ(performer("berta k", 0.04).frame, 2);

    edit::Placement more;
    more.move = glm::dvec3(0, 1, 0);
    more.turn_deg = glm::dvec3(0, 90, 0);
    more.scale = glm::dvec3(1, 1, 0.5);
    edit::place_node(file, edit::find_node(file, "berta k"), more);
    expect_near(glm::dvec3(performer("berta k").world_from_performer * glm::dvec4(0, 0, 1, 1)), {1, 1, -2}, 1e-5);
    edit::PerformerEdit change;
    change.opacity = 0.25;
    change.visible = false;
    change.spin_deg_per_s = 90;
    change.time = stage::TimeMap();
    edit::set_performer(file, edit::find_node(file, "berta k"), change);
    EXPECT_FALSE(performer("berta k").visible);
    EXPECT_EQ(performer("berta k").opacity, 0.25f);
    EXPECT_EQ(performer("berta k", 0.04).frame, 1);
    edit::rename_node(file, edit::find_node(file, "berta k"), "Carla");
    EXPECT_EQ(edit::find_node(file, "Carla"), 6u);
    edit.clip = at("clips/berta k.nvv");
    edit::add_performer(file, "Carla", edit, {});
    EXPECT_EQ(edit::find_node(file, "Carla 2"), 7u) << "names stay clear";
    expect_input_error([&] { edit::set_performer(file, 0, change); }, {"Floor", "no performer"});
}

// A matrix can be moved in the same ways as translation, rotation and scale.
TEST_F(Edits, MatricesAreMovedAsTheyAre) {
    edit::Placement placement;
    placement.matrix = glm::dmat4(1);
    (*placement.matrix)[1][0] = 0.5;  // shear
    (*placement.matrix)[3] = glm::dvec4(1, 2, 3, 1);
    const uint32_t anna = edit::find_node(file, "Anna");
    edit::place_node(file, anna, placement);
    EXPECT_TRUE(node("Anna").contains("matrix"));
    EXPECT_FALSE(node("Anna").contains("rotation"));
    edit::Placement more;
    more.move = glm::dvec3(1, 0, 0);
    more.turn_deg = glm::dvec3(0, 0, 90);
    more.scale = glm::dvec3(3, 1, 1);
    edit::place_node(file, anna, more);
    const stage::GltfNode made = stage().scene.nodes[anna];
    expect_near(glm::dvec3(made.matrix[0]), {0, 3, 0}, 1e-5);
    expect_near(glm::dvec3(made.matrix[1]), {-1, 0.5, 0}, 1e-5);
    expect_near(position(made.matrix), {2, 2, 3}, 1e-5);
    edit::Placement aimed;
    aimed.aim = glm::dvec3(2, 2, -5);
    edit::place_node(file, anna, aimed);
    const stage::Stage looking_back = stage();
    expect_near(glm::dvec3(looking_back.scene.nodes[anna].matrix[0]), {3, 0, 0}, 1e-5);
    expect_near(glm::dvec3(looking_back.scene.nodes[anna].matrix[1]), {0, std::sqrt(1.25), 0}, 1e-5);
    expect_input_error([&] { edit::place_node(file, edit::find_node(file, "Camera"), placement); },
                       {"animated", "matrix"});
    EXPECT_NE(edit::place_node(file, edit::find_node(file, "Camera"), more).find("animation moves it"),
              std::string::npos);
}

TEST_F(Edits, TheStageItselfIsSet) {
    edit::StageEdit edit;
    edit.duration_s = 9;
    edit.background = glm::dvec3(0.1, 0.2, 0.3);
    edit.environment = at("sky 1.png");
    edit.environment_rotation_deg = 45;
    edit.blend = stage::StageBlend::kPaper;
    edit.shadows = false;
    edit::set_stage(file, edit);
    const stage::Stage now = stage();
    EXPECT_EQ(now.duration_s, 9);
    EXPECT_EQ(now.fps, 30) << "as it was";
    EXPECT_EQ(now.settings.environment->uri, "sky%201.png");
    EXPECT_EQ(now.settings.environment->rotation_deg, 45);
    EXPECT_EQ(now.settings.blend, stage::StageBlend::kPaper);
    EXPECT_FALSE(now.settings.shadows);
    EXPECT_EQ(file.json["scenes"][0]["extensions"]["NEUVV_stage"]["later"], 1.0) << "unknown members stay";
    edit::StageEdit none;
    none.environment = "";
    edit::set_stage(file, none);
    EXPECT_FALSE(stage().settings.environment);
    edit::StageEdit turn;
    turn.environment_rotation_deg = 3;
    expect_input_error([&] { edit::set_stage(file, turn); }, {"environment"});
    file.json.erase("scenes");
    file.json.erase("scene");
    edit::set_stage(file, edit);
    EXPECT_EQ(stage().duration_s, 9);
    EXPECT_EQ(file.json["scenes"][0]["nodes"], ordered_json::parse("[0,1,2,3]")) << "those without parents";
}

TEST_F(Edits, Lights) {
    edit::LightEdit edit;
    edit.color = glm::dvec3(1, 0.5, 0);
    edit.intensity = 40;
    edit.inner_cone_deg = 10;
    edit.outer_cone_deg = 20;
    edit::Placement placement;
    placement.at = glm::dvec3(0, 3, 0);
    placement.aim = glm::dvec3(3, 0, 0);
    edit::add_light(file, "rim", edit, placement);
    auto rim = [&] { return stage::stage_at(stage(), 0).lights.back(); };
    EXPECT_EQ(rim().kind, stage::GltfLightKind::kSpot);
    expect_near(rim().direction, glm::normalize(glm::dvec3(1, -1, 0)), 1e-5);
    expect_near(rim().intensity, {40, 20, 0}, 1e-5);
    EXPECT_NEAR(rim().cos_outer, std::cos(glm::radians(20.0)), 1e-9);
    edit::LightEdit point;
    point.kind = "point";
    point.range_m = 4;
    edit::set_light(file, edit::find_node(file, "rim"), point);
    EXPECT_EQ(rim().kind, stage::GltfLightKind::kPoint);
    EXPECT_EQ(rim().range_m, 4);
    point.range_m = 0;
    edit::set_light(file, edit::find_node(file, "rim"), point);
    EXPECT_EQ(rim().range_m, 0) << "endless again";
    EXPECT_FALSE(file.json["extensions"]["KHR_lights_punctual"]["lights"].back().contains("range"));

    edit::duplicate_node(file, edit::find_node(file, "rim"), {});
    edit::LightEdit dim;
    dim.intensity = 1;
    edit::set_light(file, edit::find_node(file, "rim 2"), dim);
    EXPECT_EQ(stage().scene.lights.size(), 4u) << "a light of its own";
    expect_near(stage::stage_at(stage(), 0).lights[2].intensity, {40, 20, 0}, 1e-5);
    expect_near(rim().intensity, {1, 0.5, 0}, 1e-5);
    edit::remove_light(file, edit::find_node(file, "rim"));
    edit::remove_light(file, edit::find_node(file, "rim 2"));
    EXPECT_EQ(stage().scene.lights.size(), 2u);
    expect_input_error([&] { edit::remove_light(file, edit::find_node(file, "Anna")); }, {"Anna", "no light"});
    const stage::StageJson before = file.json;
    placement.aim = placement.at;
    expect_input_error([&] { edit::add_light(file, "x", edit, placement); }, {"where it shall look"});
    EXPECT_EQ(file.json, before) << "nothing was changed";
}

TEST_F(Edits, AnEmptyNameIsRefused) {
    const stage::StageJson before = file.json;
    expect_input_error([&] { edit::rename_node(file, edit::find_node(file, "Anna"), ""); }, {"Anna", "choose a name"});
    EXPECT_EQ(file.json, before);
}

TEST_F(Edits, PaintLayers) {
    const uint32_t anna = edit::find_node(file, "Anna");
    for (const char* name : {"a", "b", "c"})
        edit::add_paint_layer(file, anna, at(std::string(name) + " 1.nvpaint"), {name});
    const auto names = [&] {
        const stage::Stage now = stage();
        std::string text;
        for (const stage::PaintLayer& layer : now.performers[0].settings.paint) text += layer.name;
        return text;
    };
    EXPECT_EQ(names(), "abc");
    EXPECT_EQ(stage().performers[0].settings.paint[0].uri, "a%201.nvpaint");
    node("Anna")["extensions"]["NEUVV_performer"]["paint"][2]["who"] = "x";
    edit::move_paint_layer(file, anna, 2, 0);
    EXPECT_EQ(names(), "cab");
    edit::PaintEdit edit;
    edit.opacity = 0.5;
    edit.visible = false;
    edit.blend = stage::PaintBlend::kRecolour;
    edit::set_paint_layer(file, anna, 0, edit);
    const stage::PaintLayer layer = stage().performers[0].settings.paint[0];
    EXPECT_EQ(layer.opacity, 0.5);
    EXPECT_FALSE(layer.visible);
    EXPECT_EQ(layer.blend, stage::PaintBlend::kRecolour);
    EXPECT_EQ(node("Anna")["extensions"]["NEUVV_performer"]["paint"][0]["who"], "x");
    edit::remove_paint_layer(file, anna, 1);
    EXPECT_EQ(names(), "cb");
    expect_input_error([&] { edit::remove_paint_layer(file, anna, 2); }, {"layer 2", "0 to 1"});
    expect_input_error([&] { edit::move_paint_layer(file, anna, 0, 2); }, {"layer 2"});
    expect_input_error([&] { edit::add_paint_layer(file, 0, "x", {}); }, {"no performer"});
}

TEST_F(Edits, NodesAreFoundByNameOrIndex) {
    EXPECT_EQ(edit::find_node(file, "Anna"), 4u);
    EXPECT_EQ(edit::find_node(file, "4"), 4u);
    file.json.edit("nodes")[0]["name"] = "4";
    EXPECT_EQ(edit::find_node(file, "4"), 0u) << "names first";
    file.json.edit("nodes")[1]["name"] = "Anna";
    expect_input_error([&] { edit::find_node(file, "Anna"); }, {"2 nodes", "1, 4"});
    expect_input_error([&] { edit::find_node(file, "Berta"); }, {"Berta", "choose from", "3 \"Pivot\""});
    expect_input_error([&] { edit::find_node(file, "-1"); }, {"-1"});
    expect_input_error([&] { edit::find_node(file, "99"); }, {"99"});
    expect_input_error([&] { edit::find_node(file, ""); }, {"no node"});
}

// A plain scene has none of the extensions that operations use.
TEST_F(Edits, PlainScenesBecomeStages) {
    write_text(at("plain.gltf"), R"({"asset":{"version":"2.0"}})");
    file = stage::read_stage_file(at("plain.gltf"));
    edit::PerformerEdit edit;
    edit.clip = at("anna.nvv");
    edit::add_performer(file, "eva", edit, {});
    edit::set_stage(file, {.duration_s = 3});
    edit::add_light(file, "key", {}, {});
    edit::duplicate_node(file, edit::find_node(file, "eva"), {});
    const stage::Stage now = stage();
    EXPECT_EQ(now.performers.size(), 2u);
    EXPECT_EQ(now.duration_s, 3);
    EXPECT_EQ(stage::stage_at(now, 0).lights.size(), 1u);
    EXPECT_EQ(file.json["extensionsUsed"].size(), 3u);
    for (const char* name : {"eva", "eva 2", "key"}) edit::remove_node(file, edit::find_node(file, name));
    EXPECT_EQ(file.json["extensionsUsed"], ordered_json::parse(R"(["NEUVV_stage"])"));
}

// Bad numbers are found before anything is saved.
TEST_F(Edits, WhatCannotBeLoadedIsNotSound) {
    const stage::StageJson before = file.json;
    edit::Placement nowhere;
    nowhere.at = glm::dvec3(NAN, 0, 0);
    edit::place_node(file, 4, nowhere);
    expect_input_error([&] { stage::expect_sound_document(file); }, {"/nodes/4/translation"});
    file.json = before;
    edit::Placement flat;
    flat.scale = glm::dvec3(1, 0, 1);
    edit::place_node(file, 4, flat);
    expect_input_error([&] { stage::expect_sound_document(file); }, {"Anna", "flat"});
    file.json = before;
    edit::PerformerEdit edit;
    edit.opacity = 2;
    edit::set_performer(file, 4, edit);
    expect_input_error([&] { stage::expect_sound_document(file); }, {"opacity"});
}

}  // namespace
}  // namespace neuvv::edits_test
