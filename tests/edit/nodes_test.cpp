// Cameras, and the visibility and locks of nodes.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "edit/operations.h"
#include "stage/evaluated_stage.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/edit/foreign_stage.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;

struct Nodes : test::ForeignStage {
    stage::Stage stage() const {
        stage::expect_sound_document(file);
        return stage::make_stage(file);
    }
    uint32_t node(const std::string& name) const { return edit::find_node(file, name); }
};

TEST_F(Nodes, DraggedOnesKeepTheirPartsUnlessTheyAreSheared) {
    const uint32_t anna = node("Anna");
    const auto json = [&] { return file.json["nodes"][anna]; };
    edit::Placement turned;
    turned.at = glm::dvec3(1, 2, 3);
    turned.turn_deg = glm::dvec3(0, 30, 0);
    turned.scale = glm::dvec3(2, 2, 2);
    edit::place_node(file, anna, turned);
    const ordered_json parts_before = json();
    const stage::GltfNode there = stage().scene.nodes[anna];
    glm::dmat4 matrix = glm::mat4_cast(there.rotation) * glm::scale(glm::dmat4(1), there.scale);
    matrix[3] = glm::dvec4(4, 2, 3, 1);
    edit::Placement moved;
    moved.to = matrix;
    edit::place_node(file, anna, moved);
    EXPECT_EQ(json()["rotation"], parts_before["rotation"]);
    EXPECT_EQ(json()["scale"], parts_before["scale"]);
    EXPECT_EQ(json()["translation"], ordered_json({4.0, 2.0, 3.0}));

    matrix[0] *= -1.5;  // mirrored, and wider
    moved.to = matrix;
    edit::place_node(file, anna, moved);
    EXPECT_FALSE(json().contains("matrix"));
    const stage::GltfNode mirrored = stage().scene.nodes[anna];
    const glm::dmat4 parts = glm::mat4_cast(mirrored.rotation) * glm::scale(glm::dmat4(1), mirrored.scale);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_LT(glm::distance(glm::dvec3(parts[axis]), glm::dvec3(matrix[axis])), 1e-9) << axis;

    matrix[1][0] += 0.5;
    moved.to = matrix;
    edit::place_node(file, anna, moved);
    EXPECT_TRUE(json().contains("matrix"));
}

TEST_F(Nodes, ACameraSeesWhatItWasMadeFor) {
    glm::dmat4 world_from_camera = glm::translate(glm::dmat4(1), {1, 2, 3});
    world_from_camera = glm::rotate(world_from_camera, 0.7, glm::normalize(glm::dvec3(0.2, 1, -0.3)));
    EXPECT_NE(edit::add_camera(file, "", 0.5, world_from_camera).find("\"camera\" (node 6)"), std::string::npos);
    edit::add_camera(file, "Camera", 0.6, glm::dmat4(1));
    const stage::Stage now = stage();
    const stage::EvaluatedStage evaluated = stage::stage_at(now, 0);
    ASSERT_EQ(evaluated.cameras.size(), 3u);
    EXPECT_EQ(evaluated.cameras[2].name, "Camera 2");
    const stage::Camera camera = stage::camera_of(now, "camera", evaluated, 200, 100);
    for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(camera.world_from_camera[c] - world_from_camera[c]), 1e-12) << c;
    EXPECT_NEAR(camera.fy, 50 / std::tan(0.25), 1e-9);
    edit::remove_node(file, node("camera"));
    edit::remove_node(file, node("Camera 2"));
    EXPECT_EQ(file.json, before) << "nothing stays of them";
}

TEST_F(Nodes, ASharedCameraBecomesTheNodesOwn) {
    edit::duplicate_node(file, node("Pivot"), {});
    file.json.edit("nodes")[node("Pivot")]["camera"] = 0;
    edit::set_camera(file, node("Pivot"), 0.25);
    const auto angle = [&](const char* name) {
        const stage::Stage now = stage();
        for (const stage::EvaluatedCamera& camera : stage::stage_at(now, 0).cameras)
            if (camera.name == name) return camera.vertical_angle_rad;
        return 0.0;
    };
    EXPECT_EQ(angle("Pivot"), 0.25);
    EXPECT_EQ(angle("Camera"), 0.8);
    EXPECT_EQ(file.json["cameras"][1]["perspective"]["znear"], 0.10000000149011612) << "all else is as it was";
    edit::set_camera(file, node("Camera"), 0.5);
    EXPECT_EQ(file.json["cameras"].size(), 2u);
    EXPECT_EQ(angle("Camera"), 0.5);
    expect_input_error([&] { edit::set_camera(file, node("Anna"), 1); }, {"Anna", "no camera"});
    expect_input_error([&] { edit::set_camera(file, 99, 1); }, {"99"});
    edit::set_camera(file, node("Camera"), 4);
    expect_input_error([&] { stage::expect_sound_document(file); }, {"/cameras/0/perspective/yfov"});
    file.json.edit("cameras")[0] = {{"type", "orthographic"},
                                    {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 0}}}};
    expect_input_error([&] { edit::set_camera(file, node("Camera"), 1); }, {"Camera", "orthographic"});
}

TEST_F(Nodes, ShownAndHidden) {
    for (const char* name : {"Pivot", "Anna", "Floor", "Spot"}) {
        edit::show_node(file, node(name), false);
        EXPECT_FALSE(edit::is_visible(file, node(name)));
    }
    EXPECT_TRUE(edit::is_visible(file, node("Sun"))) << "what hangs on a hidden node says nothing itself";
    stage::Stage now = stage();
    stage::EvaluatedStage evaluated = stage::stage_at(now, 0);
    EXPECT_FALSE(evaluated.performers[0].visible);
    EXPECT_TRUE(evaluated.lights.empty());
    EXPECT_FALSE(now.scene.nodes[node("Floor")].draws_mesh());
    EXPECT_EQ(evaluated.cameras.size(), 1u);
    for (const char* name : {"Pivot", "Anna", "Floor", "Spot"}) edit::show_node(file, node(name), true);
    EXPECT_EQ(file.json, before);
    edit::show_node(file, node("Pivot"), false);
    edit::duplicate_node(file, node("Pivot"), {});
    EXPECT_FALSE(edit::is_visible(file, node("Pivot 2")));
    for (const char* name : {"Pivot", "Pivot 2"}) edit::remove_node(file, node(name));
    for (const ordered_json& used : file.json["extensionsUsed"]) EXPECT_NE(used, "KHR_node_visibility");
}

TEST_F(Nodes, APerformersOwnVisibilityStillCounts) {
    edit::PerformerEdit edit;
    edit.visible = false;
    edit::set_performer(file, node("Anna"), edit);
    EXPECT_FALSE(edit::is_visible(file, node("Anna")));
    EXPECT_FALSE(stage::stage_at(stage(), 0).performers[0].visible);
    edit::show_node(file, node("Anna"), true);
    EXPECT_EQ(file.json, before);
    EXPECT_TRUE(stage::stage_at(stage(), 0).performers[0].visible);
}

TEST_F(Nodes, LocksAreSaidAndNotEnforced) {
    EXPECT_FALSE(edit::is_locked(file, node("Anna")));
    edit::lock_node(file, node("Anna"), true);
    edit::lock_node(file, node("Floor"), true);
    EXPECT_TRUE(edit::is_locked(file, node("Anna")));
    EXPECT_EQ(file.json["nodes"][4]["extras"], ordered_json::parse(R"({"cast":true,"neuvv":{"locked":true}})"));
    edit::Placement away;
    away.move = glm::dvec3(1, 0, 0);
    EXPECT_NO_THROW(edit::place_node(file, node("Anna"), away));
    file.json.edit("nodes")[4].erase("translation");
    stage::save_stage_file(file, folder.path / "locked.gltf");
    EXPECT_TRUE(edit::is_locked(stage::load_stage(folder.path / "locked.gltf").file, node("Floor")));
    for (const char* name : {"Anna", "Floor", "Spot"}) edit::lock_node(file, node(name), false);
    EXPECT_EQ(file.json, before);
    // Extras belong to any program and may have any type.
    for (const char* extras : {"7", R"("locked")", "[1]", R"({"neuvv":3})", R"({"neuvv":{"locked":"yes"}})"}) {
        file.json.edit("nodes")[0]["extras"] = ordered_json::parse(extras);
        EXPECT_FALSE(edit::is_locked(file, 0)) << extras;
    }
    edit::lock_node(file, 0, true);
    EXPECT_TRUE(edit::is_locked(file, 0));
    file.json.edit("nodes")[0]["extras"] = 7;
    expect_input_error([&] { edit::lock_node(file, 0, true); }, {"/nodes/0/extras"});
    EXPECT_EQ(file.json["nodes"][0]["extras"], 7);
    EXPECT_NO_THROW(edit::lock_node(file, 0, false));
}

}  // namespace
}  // namespace neuvv
