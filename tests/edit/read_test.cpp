// Values read from documents: they are those that the engine loads, and whatever is optional may be missing.
#include "edit/read.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "edit/light_values.h"
#include "edit/operations.h"
#include "edit/paint_layers.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "support/near.h"
#include "tests/edit/foreign_stage.h"

namespace neuvv {
namespace {

using Indices = std::vector<uint32_t>;
using test::expect_near;

struct Read : test::ForeignStage {
    uint32_t node(const char* name) const { return edit::find_node(file, name); }
};

stage::StageFile document(const std::string& members) {
    return stage::make_stage_file("/nowhere/stage.gltf", R"({"asset": {"version": "2.0"})" + members + "}");
}

glm::dmat4 matrix_of(const edit::NodeTransform& transform) {
    return glm::translate(glm::dmat4(1), transform.translation) * glm::mat4_cast(transform.rotation) *
           glm::scale(glm::dmat4(1), transform.scale);
}

TEST_F(Read, NodesAreThoseOfTheEngine) {
    const stage::Stage stage = stage::make_stage(file);
    ASSERT_EQ(edit::node_count(file), stage.scene.nodes.size());
    const std::vector<bool> in_scene = edit::nodes_in_scene(file);
    ASSERT_EQ(in_scene.size(), stage.scene.nodes.size());
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i) {
        const stage::GltfNode& loaded = stage.scene.nodes[i];
        EXPECT_EQ(edit::name_of(file, i), loaded.name);
        EXPECT_EQ(edit::node_title(file, i), stage::node_title(stage.scene, i));
        EXPECT_EQ(edit::children_of(file, i), loaded.children);
        EXPECT_EQ(in_scene[i], loaded.in_scene) << i;
        const edit::NodeTransform transform = edit::transform_of(file, i);
        EXPECT_EQ(transform.translation, loaded.translation);
        EXPECT_EQ(transform.scale, loaded.scale);
        EXPECT_NEAR(std::abs(glm::dot(transform.rotation, loaded.rotation)), 1, 1e-12);
        const auto camera = edit::camera_on(file, i);
        ASSERT_EQ(camera.has_value(), loaded.camera >= 0) << i;
        if (camera) {
            const stage::GltfCamera& lens = stage.scene.cameras[static_cast<size_t>(loaded.camera)];
            EXPECT_EQ(camera->name, lens.name);
            EXPECT_EQ(camera->orthographic, lens.orthographic);
            EXPECT_EQ(camera->vertical_angle_rad, lens.vertical_angle_rad);
        }
        EXPECT_EQ(edit::light_on(file, i).has_value(), loaded.light >= 0) << i;
    }
    EXPECT_EQ(edit::scene_roots(file), (Indices{0, 1, 2, 3}));
    EXPECT_EQ(edit::family_of(file, node("Pivot")), (Indices{3, 4, 5}));
    EXPECT_TRUE(edit::is_animated(file, node("Camera")));
    EXPECT_FALSE(edit::is_animated(file, node("Anna")));
}

TEST_F(Read, ThePerformerAndTheStageAreThoseOfTheEngine) {
    edit::add_path_key(file, {}, 0.04);
    const stage::Stage stage = stage::make_stage(file);
    const auto performer = edit::performer_on(file, node("Anna"));
    ASSERT_TRUE(performer);
    EXPECT_EQ(stage::text_of(performer->time), stage::text_of(stage.performers.at(0).settings.time));
    EXPECT_EQ(performer->spin_deg_per_s, 90);
    EXPECT_EQ(performer->opacity, 0.5);
    EXPECT_EQ(edit::clip_of(file, node("Anna")), folder.path / "anna.nvv");
    EXPECT_FALSE(edit::performer_on(file, node("Floor")));
    expect_input_error([&] { edit::clip_of(file, node("Floor")); }, {"Floor", "no performer"});
    const stage::StageSettings settings = edit::stage_settings_of(file);
    EXPECT_EQ(settings.duration_s, 4);
    EXPECT_EQ(settings.fps, 30);
    EXPECT_EQ(settings.ambient, glm::dvec3(0.1, 0.1, 0.2));
    ASSERT_TRUE(settings.camera_path && edit::camera_path_of(file));
    EXPECT_EQ(edit::camera_path_of(file)->keys.size(), settings.camera_path->keys.size());
}

TEST_F(Read, AnOrthographicCameraHasNoAngle) {
    file.json.edit("cameras")[0] = {{"type", "orthographic"},
                                    {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 0}}}};
    const auto camera = edit::camera_on(file, node("Camera"));
    ASSERT_TRUE(camera);
    EXPECT_TRUE(camera->orthographic);
    EXPECT_EQ(camera->vertical_angle_rad, 0);
}

TEST(ReadTransforms, AMatrixIsTakenApart) {
    edit::NodeTransform written{
        {0.5, 1, -2}, glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3))), {-1.5, 2, 0.25}};
    stage::StageFile file = document(R"(, "nodes": [{"name": "a"}])");
    edit::place_node(file, 0, {.matrix = matrix_of(written)});
    ASSERT_TRUE(file.json["nodes"][0].contains("matrix"));
    const edit::NodeTransform read = edit::transform_of(file, 0);
    expect_near(read.translation, written.translation);
    expect_near(read.scale, written.scale);
    EXPECT_NEAR(std::abs(glm::dot(read.rotation, written.rotation)), 1, 1e-12);
}

TEST(ReadTransforms, AShearedMatrixKeepsItsXAxis) {
    glm::dmat4 matrix(1);
    matrix[0] = {0, 2, 0, 0};
    matrix[1] = {-3, 1, 0, 0};
    stage::StageFile file = document(R"(, "nodes": [{"name": "a"}])");
    edit::place_node(file, 0, {.matrix = matrix});
    const edit::NodeTransform read = edit::transform_of(file, 0);
    expect_near(read.rotation * glm::dvec3(1, 0, 0), {0, 1, 0});
    expect_near(read.rotation * glm::dvec3(0, 1, 0), {-1, 0, 0});
    expect_near(read.scale, {2, std::sqrt(10), 1});
}

TEST(ReadTransforms, AFlatMatrixHasSomeTransform) {
    const stage::StageFile file =
        document(R"(, "nodes": [{"matrix": [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]}])");
    const edit::NodeTransform read = edit::transform_of(file, 0);
    expect_near(read.translation, {4, 5, 6});
    expect_near(read.scale, {1, 0, 1});
    EXPECT_TRUE(std::isfinite(glm::dot(read.rotation, read.rotation)));
}

TEST(ReadCameraPath, IsThatOfTheDefaultScene) {
    stage::StageFile file = document(R"(, "scene": 1, "scenes": [{}, {"nodes": []}])");
    EXPECT_FALSE(edit::camera_path_of(file));
    EXPECT_FALSE(edit::camera_path_of(document("")));
    stage::CameraPathKey key;
    key.time_s = 1.5;
    edit::add_path_key(file, key, 0.04);
    const std::optional<stage::CameraPath> path = edit::camera_path_of(file);
    ASSERT_TRUE(path);
    ASSERT_EQ(path->keys.size(), 1u);
    EXPECT_EQ(path->keys[0].time_s, 1.5);
    edit::remove_path_key(file, 0);
    EXPECT_FALSE(edit::camera_path_of(file));
}

TEST(ReadHostile, ADocumentMaySayNothing) {
    const stage::StageFile file = document("");
    EXPECT_EQ(edit::node_count(file), 0u);
    EXPECT_TRUE(edit::scene_roots(file).empty());
    EXPECT_TRUE(edit::nodes_in_scene(file).empty());
    EXPECT_TRUE(edit::used_layers(file).empty());
    const stage::StageSettings settings = edit::stage_settings_of(file);
    EXPECT_FALSE(settings.duration_s || settings.fps || settings.ambient || settings.environment);
    EXPECT_TRUE(settings.shadows && settings.falloff);
    expect_input_error([&] { edit::find_node(file, "0"); }, {"no node", "the stage has none"});
}

TEST(ReadHostile, ANodeMaySayNothing) {
    const stage::StageFile file = document(R"(, "scenes": [{}], "nodes": [{}])");
    EXPECT_EQ(edit::name_of(file, 0), "");
    EXPECT_EQ(edit::node_title(file, 0), "node 0");
    EXPECT_EQ(edit::kind_of(file, 0), edit::NodeKind::kGroup);
    EXPECT_TRUE(edit::children_of(file, 0).empty());
    EXPECT_EQ(edit::family_of(file, 0), Indices{0});
    EXPECT_TRUE(edit::scene_roots(file).empty()) << "the scene has none";
    EXPECT_EQ(edit::nodes_in_scene(file), std::vector<bool>{false});
    EXPECT_EQ(matrix_of(edit::transform_of(file, 0)), glm::dmat4(1));
    EXPECT_FALSE(edit::is_animated(file, 0));
    EXPECT_TRUE(edit::is_visible(file, 0));
    EXPECT_FALSE(edit::is_locked(file, 0));
    EXPECT_FALSE(edit::light_on(file, 0) || edit::camera_on(file, 0) || edit::performer_on(file, 0));
    EXPECT_FALSE(edit::paint_layers_of(file, 0));
}

TEST(ReadHostile, WhatANodeHasMayBeBare) {
    const stage::StageFile file = document(R"(, "nodes": [
        {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"camera": 0},
        {"extensions": {"NEUVV_performer": {"uri": "a.nvv"}, "KHR_lights_punctual": {"light": 0}}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot"}]}},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}], "animations": [{}])");
    const auto light = edit::light_on(file, 0);
    ASSERT_TRUE(light);
    EXPECT_EQ(light->kind, stage::GltfLightKind::kSpot);
    EXPECT_EQ(light->color, glm::dvec3(1));
    EXPECT_EQ(light->intensity, 1);
    EXPECT_EQ(light->range_m, 0);
    EXPECT_EQ(light->inner_cone_deg, 0);
    EXPECT_EQ(light->outer_cone_deg, 45);
    EXPECT_EQ(edit::camera_on(file, 1)->name, "");
    EXPECT_EQ(edit::kind_of(file, 2), edit::NodeKind::kPerformer) << "the first kind of two";
    const auto performer = edit::performer_on(file, 2);
    ASSERT_TRUE(performer);
    EXPECT_TRUE(performer->time.empty());
    EXPECT_EQ(performer->opacity, 1);
    EXPECT_TRUE(edit::paint_layers_of(file, 2)->empty());
    EXPECT_FALSE(edit::is_animated(file, 1)) << "an animation without channels";
}

TEST(ReadHostile, WhatIsNobodysMayBeAnything) {
    const stage::StageFile file = document(R"(, "nodes": [
        {"name": 7, "extensions": 3, "extras": [1]},
        {"name": null, "extensions": {"ACME_fog": true}, "extras": {"neuvv": "locked"}},
        {"extensions": [], "extras": {"neuvv": {"locked": "yes"}}}],
        "extensions": [], "animations": [{"channels": [{}, {"target": {}}, {"target": {"node": "0"}}]}])");
    for (uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(edit::node_title(file, i), "node " + std::to_string(i));
        EXPECT_EQ(edit::kind_of(file, i), edit::NodeKind::kGroup);
        EXPECT_FALSE(edit::light_on(file, i) || edit::performer_on(file, i) || edit::paint_layers_of(file, i));
        EXPECT_TRUE(edit::is_visible(file, i));
        EXPECT_FALSE(edit::is_locked(file, i));
        EXPECT_FALSE(edit::is_animated(file, i));
    }
}

TEST(ReadHostile, WithoutScenesAllNodesAreShown) {
    const stage::StageFile file =
        document(R"(, "scene": 2, "scenes": [], "nodes": [{"children": [2]}, {}, {"children": [3]}, {}])");
    EXPECT_EQ(edit::scene_roots(file), (Indices{0, 1}));
    EXPECT_EQ(edit::nodes_in_scene(file), std::vector<bool>(4, true));
}

TEST(ReadHostile, ANodeThatDoesNotExistHasNothingOnIt) {
    const stage::StageFile file = document(R"(, "nodes": [{}])");
    EXPECT_FALSE(edit::light_on(file, 1) || edit::camera_on(file, 1) || edit::performer_on(file, 1));
    EXPECT_FALSE(edit::paint_layers_of(file, 1));
    const std::vector<std::function<void()>> questions = {
        [&] { edit::name_of(file, 1); },      [&] { edit::kind_of(file, 1); },    [&] { edit::children_of(file, 1); },
        [&] { edit::transform_of(file, 1); }, [&] { edit::is_visible(file, 1); }, [&] { edit::is_locked(file, 1); },
        [&] { edit::clip_of(file, 1); },
    };
    for (const auto& ask : questions) expect_input_error(ask, {"node 1 does not exist"});
}

TEST(ReadHostile, NumbersOutOfTheirRangeAreReportedByTheirPlace) {
    const stage::StageFile file = document(R"(, "scenes": [{"extensions": {"NEUVV_stage": {"fps": -1}}}],
        "nodes": [{"extensions": {"NEUVV_performer": {"uri": "a.nvv", "opacity": 2}}}])");
    expect_input_error([&] { edit::performer_on(file, 0); }, {"/nodes/0/extensions/NEUVV_performer", "opacity"});
    expect_input_error([&] { edit::stage_settings_of(file); }, {"NEUVV_stage", "fps"});
    EXPECT_FALSE(edit::camera_path_of(file)) << "it is asked alone";
}

TEST(ReadNodes, AreTheSameUpToTheFirstThatDiffers) {
    const stage::StageFile a = document(R"(, "nodes": [{"name": "a"}, {"name": "b"}])"),
                           b = document(R"(, "nodes": [{"name": "a"}, {"name": "c"}, {}])");
    EXPECT_TRUE(edit::same_nodes(a, b, 0));
    EXPECT_TRUE(edit::same_nodes(a, b, 1));
    EXPECT_FALSE(edit::same_nodes(a, b, 2));
    EXPECT_FALSE(edit::same_nodes(a, a, 3)) << "there are but two";
    EXPECT_FALSE(edit::same_nodes(document(""), a, 1));
}

}  // namespace
}  // namespace neuvv
