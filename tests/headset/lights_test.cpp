// Lights and cameras in the headset: pointed at, held, aimed, and changed by the panel.
#include <fmt/format.h>

#include "edit/light_values.h"
#include "headset/panel_at_a_stage.h"
#include "tools/headset/hand_shapes.h"
#include "tools/headset/labels.h"
#include "tools/headset/markers.h"

namespace neuvv::test {
namespace {

struct HeadsetLights : PanelAtAStage {
    const glm::dvec3 lamp{-0.5, 2.2, -1}, camera{0.9, 1.6, -0.5};
    HeadsetLights() {
        for (const auto& [node, at] : {std::pair{"key", lamp}, {"camera", camera}}) {
            const char* name = node;  // which clang 14 does not let a lambda capture as a structured binding
            edit::Placement placement;
            placement.at = at;
            placement.aim = glm::dvec3(0, 0, -2);
            edit_stage(
                [&](stage::StageFile& file) { return edit::place_node(file, edit::find_node(file, name), placement); });
        }
        state.editor.open(state.editor.document(), false);
        state.tool = headset::HandTool::kLights;
        find_surfaces = [this](std::span<const Ray> rays) {
            std::vector<std::optional<headset::SurfaceHit>> hits;
            for (const Ray& ray : rays) hits.push_back(ben_fills_his_box ? hit_of_ben(ray) : std::nullopt);
            return hits;
        };
        point(xr::kLeft, kLeftHand, {-5, 1, 0});
        draw();
    }
    void edit_stage(const std::function<std::string(stage::StageFile&)>& operation) {
        ASSERT_TRUE(state.editor.edit([&](edit::Document& document) { return operation(document.file); }));
    }
    std::optional<headset::SurfaceHit> hit_of_ben(const Ray& ray) const {
        const auto [low, high] = editor::box_of(state, 1);
        const auto distance_m = box_hit(ray, state.evaluated.performers[1].world_from_performer, low, high);
        return distance_m ? std::optional(headset::SurfaceHit{1, *distance_m}) : std::nullopt;
    }
    bool ben_fills_his_box = true;  // else rays meet his box alone
    const headset::PointerHit& hit() const { return interaction.hands[xr::kRight].hit; }
    glm::dvec3 direction(const std::string& name) const {
        return -glm::normalize(glm::dvec3(state.evaluated.pose.world_from_node[node(name)][2]));
    }
    edit::LightValues light() const { return *edit::light_on(state.editor.file(), node("key")); }
    void expect_looks_at(const std::string& name, glm::dvec3 from, glm::dvec3 at) const {
        EXPECT_LT(glm::distance(direction(name), glm::normalize(at - from)), 1e-6) << name;
    }
};

TEST_F(HeadsetLights, ARayMeetsMarkersWithTheToolAlone) {
    for (const auto& [name, at] : {std::pair{"key", lamp}, {"camera", camera}}) {
        point(xr::kRight, kRightHand, at);
        draw();
        ASSERT_EQ(hit().target, headset::PointerHit::Target::kMarker) << name;
        EXPECT_EQ(hit().node, node(name));
        EXPECT_NEAR(hit().distance_m, glm::distance(kRightHand, at), 1e-6);
        EXPECT_GT(interaction.hands[xr::kRight].vibration, 0) << "the hand feels it";
    }
    state.tool = headset::HandTool::kArrange;
    draw();
    EXPECT_NE(hit().target, headset::PointerHit::Target::kMarker);
}

TEST_F(HeadsetLights, APerformerBeforeAMarkerIsMetFirst) {
    edit_stage([&](stage::StageFile& file) {
        edit::Placement behind;
        behind.at = kBen + glm::dvec3(0, 0, -3);
        return edit::place_node(file, node("key"), behind);
    });
    draw();
    point(xr::kRight, kBen + glm::dvec3(0, 0, 2), kBen);
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kPerformer);
    ben_fills_his_box = false;
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kMarker) << "his box hides nothing";
    point(xr::kRight, kBen + glm::dvec3(0, 0, 2), kBen + glm::dvec3(0, -3, 0));
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kFloor) << "and nothing looks at it";
}

TEST_F(HeadsetLights, TheGripMovesAndTurnsInOneStep) {
    for (const auto& [name, at] : {std::pair{"key", lamp}, {"camera", camera}}) {
        const glm::dvec3 before = direction(name);
        point(xr::kRight, kRightHand, at);
        draw();
        inputs[xr::kRight].grab = 1;
        draw();
        ASSERT_TRUE(interaction.lights.is_holding(xr::kRight)) << name;
        const glm::dvec3 moved(0.3, 0.2, -0.1);
        point(xr::kRight, kRightHand + moved, at + moved);
        const uint64_t id = state.editor.id();
        draw();
        EXPECT_EQ(state.editor.id(), id) << "a hold alone edits nothing";
        EXPECT_LT(glm::distance(position(name), at + moved), 1e-6) << name;
        if (name == std::string("key"))
            EXPECT_LT(glm::distance(state.evaluated.lights[0].position, at + moved), 1e-6) << "and it shines there";
        else
            EXPECT_LT(glm::distance(glm::dvec3(state.evaluated.cameras[0].world_from_camera[3]), at + moved), 1e-6);
        // The hand rolls about its own ray: the point that it holds stays, and what it holds turns.
        inputs[xr::kRight].aim->rotation *= glm::angleAxis(0.7, glm::dvec3(0, 0, 1));
        draw();
        inputs[xr::kRight].grab = 0;
        draw();
        draw();
        EXPECT_LT(glm::distance(position(name), at + moved), 1e-6) << name;
        const glm::dvec3 axis = glm::normalize(at - kRightHand);
        EXPECT_LT(glm::distance(direction(name), glm::angleAxis(-0.7, axis) * before), 1e-6) << name;
        EXPECT_EQ(state.editor.selected(), node(name));
        EXPECT_EQ(steps(), 1u);
    }
}

TEST_F(HeadsetLights, TheStickPushesWhatIsHeldAndNobodyWalks) {
    point(xr::kRight, kRightHand, lamp);
    draw();
    inputs[xr::kRight].grab = 1;
    draw();
    inputs[xr::kRight].stick = {0, 1};
    const double speed = state.clock.speed;
    for (int i = 0; i < 18; ++i) draw();
    inputs[xr::kRight].stick = {0, 0};
    inputs[xr::kRight].grab = 0;
    draw();
    draw();
    EXPECT_NEAR(glm::distance(position("key"), lamp), 2.5 * 18 / 90, 0.01);
    EXPECT_EQ(state.clock.speed, speed);
}

TEST_F(HeadsetLights, SidewaysTheStickChangesTheOpeningInTheSameStep) {
    for (const auto& [name, at] : {std::pair{"key", lamp}, {"camera", camera}}) {
        const bool is_light = name == std::string("key");
        const auto opening = [&] {
            return is_light ? light().outer_cone_deg
                            : glm::degrees(edit::camera_on(state.editor.file(), node("camera"))->vertical_angle_rad);
        };
        const double before = opening(), softness = edit::softness_of(light().inner_cone_deg, light().outer_cone_deg);
        point(xr::kRight, kRightHand, at);
        draw();
        inputs[xr::kRight].grab = 1;
        draw();
        inputs[xr::kRight].stick = {0.5, 0.3};
        const uint64_t id = state.editor.id();
        for (int i = 0; i < 45; ++i) draw();
        EXPECT_EQ(state.editor.id(), id) << "a hold alone edits nothing";
        const double wide = before * std::exp2(0.5 * 45 / 90);
        if (is_light)
            EXPECT_NEAR(state.evaluated.lights[0].cos_outer, std::cos(glm::radians(wide)), 1e-9) << "it is seen";
        else
            EXPECT_NEAR(state.evaluated.cameras[0].vertical_angle_rad, glm::radians(wide), 1e-9);
        const auto label = headset::label_of_ray(state, interaction, xr::kRight);
        ASSERT_TRUE(label);
        EXPECT_EQ(label->text, fmt::format("{} {:.0f}°", is_light ? "shines" : "sees", wide));
        EXPECT_NEAR(label->distance_m, glm::distance(kRightHand, at), 1e-6) << "it is not pushed";
        inputs[xr::kRight].stick = {0, 0};
        inputs[xr::kRight].grab = 0;
        draw();
        draw();
        EXPECT_NEAR(opening(), wide, 1e-6) << name;
        if (is_light) {
            EXPECT_NEAR(edit::softness_of(light().inner_cone_deg, light().outer_cone_deg), softness, 1e-6);
        }
        EXPECT_LT(glm::distance(position(name), at), 1e-6) << name;
        EXPECT_FALSE(headset::label_of_ray(state, interaction, xr::kRight));
        EXPECT_EQ(state.rig.yaw_rad, 0) << "nobody is turned";
        EXPECT_EQ(steps(), 1u);
    }
}

TEST_F(HeadsetLights, TheStickOpensNoFurtherThanThePanel) {
    point(xr::kRight, kRightHand, camera);
    draw();
    inputs[xr::kRight].grab = 1;
    draw();
    for (const auto& [stick, end_deg] : {std::pair{1.0, 120.0}, {-1.0, 10.0}}) {
        inputs[xr::kRight].stick = {stick, 0};
        for (int i = 0; i < 500; ++i) draw();
        EXPECT_NEAR(state.evaluated.cameras[0].vertical_angle_rad, glm::radians(end_deg), 1e-9);
    }
}

TEST_F(HeadsetLights, TheSetIsMetAndLookedAt) {
    // The floor's disk as a wall behind the user's right hand.
    edit_stage([&](stage::StageFile& file) {
        edit::Placement wall;
        wall.at = glm::dvec3(1.5, 1, 0);
        wall.turn_deg = glm::dvec3(0, 0, 90);
        return edit::place_node(file, node("floor"), wall);
    });
    select(lamp);
    const glm::dvec3 on_wall(1.5, 1.3, 0.2);
    point(xr::kRight, kRightHand, on_wall);
    draw();
    ASSERT_EQ(hit().target, headset::PointerHit::Target::kSet);
    EXPECT_NEAR(hit().distance_m, glm::distance(kRightHand, on_wall), 1e-5);
    select(on_wall);
    draw();
    expect_looks_at("key", lamp, on_wall);
    const Ray beyond{kRightHand, glm::normalize(on_wall - kRightHand)};
    point(xr::kRight, beyond.origin, beyond.origin + beyond.direction);
    state.shows_room = true;
    draw();
    EXPECT_NE(hit().target, headset::PointerHit::Target::kSet) << "the room is shown in its place";
    state.shows_room = false;
    state.tool = headset::HandTool::kArrange;
    draw();
    EXPECT_NE(hit().target, headset::PointerHit::Target::kSet) << "with other tools, rays go through it";
}

TEST_F(HeadsetLights, TheSetHidesPerformersButNoMarkers) {
    edit_stage([&](stage::StageFile& file) {
        edit::Placement wall;
        wall.at = glm::dvec3(0, 1, -0.4);
        wall.turn_deg = glm::dvec3(90, 0, 0);
        return edit::place_node(file, node("floor"), wall);
    });
    point(xr::kRight, kRightHand, kBen);
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kSet);
    point(xr::kRight, kRightHand, lamp + glm::dvec3(0.4, 0, 0));
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kSet) << "the wall is before the lamp, too";
    point(xr::kRight, kRightHand, lamp);
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kMarker) << "a lamp in a ceiling can be held";
}

TEST_F(HeadsetLights, TheTriggerAimsTheSelectedOne) {
    for (const auto& [name, at] : {std::pair{"key", lamp}, {"camera", camera}}) {
        select(at);
        ASSERT_EQ(state.editor.selected(), node(name));
        const glm::dvec3 floor(0.4, 0, -1.2);
        point(xr::kRight, kRightHand, {0, 0, -1});
        draw();
        inputs[xr::kRight].select = 1;
        draw();
        point(xr::kRight, kRightHand, floor);
        const uint64_t id = state.editor.id();
        draw();
        EXPECT_EQ(state.editor.id(), id);
        expect_looks_at(name, at, floor);
        const glm::dvec3 shines = name == std::string("key")
                                      ? state.evaluated.lights[0].direction
                                      : -glm::dvec3(state.evaluated.cameras[0].world_from_camera[2]);
        EXPECT_LT(glm::distance(shines, glm::normalize(floor - at)), 1e-6);
        point(xr::kRight, kRightHand, {0, 9, -1});  // the ray meets nothing: the aim stays
        draw();
        expect_looks_at(name, at, floor);
        inputs[xr::kRight].select = 0;
        draw();
        draw();
        expect_looks_at(name, at, floor);
        EXPECT_LT(glm::distance(position(name), at), 1e-9) << "it stays where it is";
        EXPECT_EQ(state.editor.selected(), node(name));
        EXPECT_EQ(steps(), 1u);
    }
}

// As a user does one after the other: the stage's file has all of it.
TEST_F(HeadsetLights, AGripAndItsStickOpenALampThatThenLooksAtTheSet) {
    edit_stage([&](stage::StageFile& file) {
        edit::Placement wall;
        wall.at = glm::dvec3(1.5, 1, 0);
        wall.turn_deg = glm::dvec3(0, 0, 90);
        return edit::place_node(file, node("floor"), wall);
    });
    draw();
    EXPECT_TRUE(has("brightness")) << "the rows are there before a light is selected";
    const double before_deg = light().outer_cone_deg;
    point(xr::kRight, kRightHand, lamp);
    draw();
    inputs[xr::kRight].grab = 1;
    draw();
    inputs[xr::kRight].stick = {-1, 0};
    for (int i = 0; i < 22; ++i) draw();
    inputs[xr::kRight].stick = {0, 0};
    inputs[xr::kRight].grab = 0;
    draw();
    const glm::dvec3 on_wall(1.5, 1.0, -0.4);
    select(on_wall);
    draw();
    const std::filesystem::path saved = folder.path / "saved.gltf";
    edit::Document document = state.editor.document();
    edit::save_document(document, saved);
    const stage::StageFile file = stage::read_stage_file(saved);
    const uint32_t key = edit::find_node(file, "key");
    EXPECT_LT(edit::light_on(file, key)->outer_cone_deg, before_deg * 0.95);
    const edit::NodeTransform placed = edit::transform_of(file, key);
    EXPECT_LT(glm::distance(placed.translation, lamp), 0.01);
    EXPECT_LT(glm::distance(placed.rotation * glm::dvec3(0, 0, -1), glm::normalize(on_wall - placed.translation)),
              0.01);
    EXPECT_EQ(state.rig.yaw_rad, 0) << "the stick turned nobody";
}

TEST_F(HeadsetLights, APerformerUnderTheRayIsLookedAt) {
    select(lamp);
    point(xr::kRight, kRightHand, kBen);
    draw();
    ASSERT_EQ(hit().target, headset::PointerHit::Target::kPerformer);
    const Ray ray = xr::ray_of(*interaction.hands[xr::kRight].aim);
    const glm::dvec3 met = ray.origin + hit().distance_m * ray.direction;
    select(kBen);
    draw();
    expect_looks_at("key", lamp, met);
    EXPECT_EQ(state.editor.selected(), node("key")) << "the performer is not selected instead";
}

TEST_F(HeadsetLights, WhatIsLockedStays) {
    edit_stage([&](stage::StageFile& file) { return edit::lock_node(file, node("key"), true); });
    state.editor.open(state.editor.document(), false);
    select(lamp);
    inputs[xr::kRight].grab = 1;
    draw();
    EXPECT_FALSE(interaction.lights.is_active());
    inputs[xr::kRight].grab = 0;
    select({0, 0, -1});
    EXPECT_TRUE(was_notified("it is locked"));
    EXPECT_EQ(steps(), 0u);
}

TEST_F(HeadsetLights, ItsRowsAreTheSameWhateverIsSelected) {
    draw_settled();
    const auto nothing = items;
    for (const char* name : {"light colour", "brightness", "cone", "field of view"}) {
        EXPECT_TRUE(has(name)) << name;
        drag(name, {-0.01, -0.03});
    }
    EXPECT_EQ(steps(), 0u) << "they are grey";
    for (const glm::dvec3 at : {lamp, camera}) {
        select(at);
        draw_settled();
        EXPECT_EQ(items, nothing);
    }
}

TEST_F(HeadsetLights, ThePanelSetsBrightnessAndColourOfALight) {
    select(lamp);
    draw();
    const edit::LightValues before = light();
    drag("field of view", {0.05});
    drag("brightness", {0.05, 0.1});
    EXPECT_GT(light().intensity, 1.2 * before.intensity);
    drag("cone", {0.05});
    EXPECT_GT(light().outer_cone_deg, before.outer_cone_deg);
    EXPECT_LT(light().inner_cone_deg, light().outer_cone_deg);
    drag("light colour", {-0.01, -0.03});
    EXPECT_NE(light().color, before.color);
    EXPECT_EQ(steps(), 3u);
}

TEST_F(HeadsetLights, ThePanelSetsACamerasFieldOfView) {
    select(camera);
    draw();
    drag("brightness", {0.05});
    drag("cone", {0.05});
    const double before = edit::camera_on(state.editor.file(), node("camera"))->vertical_angle_rad;
    drag("field of view", {0.05, 0.2});
    EXPECT_GT(edit::camera_on(state.editor.file(), node("camera"))->vertical_angle_rad, before);
    EXPECT_EQ(steps(), 1u);
}

TEST_F(HeadsetLights, MarkersAreDrawnWithTheToolAlone) {
    const auto corners_near = [&](glm::dvec3 at) {
        xr::EyeShapes shapes;
        shapes.begin(head.position, 0);
        headset::draw_interaction(shapes, state, interaction);
        size_t count = 0;
        for (const xr::ShapeVertex& corner : shapes.solid())
            count += glm::distance(glm::dvec3(corner.position), at) < 0.1;
        return count;
    };
    EXPECT_GT(corners_near(lamp), 20u);
    EXPECT_GT(corners_near(camera), 20u);
    state.tool = headset::HandTool::kArrange;
    EXPECT_EQ(corners_near(lamp), 0u);
    EXPECT_EQ(corners_near(camera), 0u);
}

TEST_F(HeadsetLights, ACameraAroundTheUsersHeadHasNoMarker) {
    ASSERT_EQ(headset::markers_of(state).size(), 2u);
    state.rig.position = camera - head.position + glm::dvec3(0.1, 0.2, 0);
    draw();
    ASSERT_EQ(headset::markers_of(state).size(), 1u);
    EXPECT_FALSE(headset::markers_of(state)[0].is_camera);
}

TEST_F(HeadsetLights, FarMarkersAreLargerSoThatARayMeetsThem) {
    edit_stage([&](stage::StageFile& file) {
        edit::Placement far;
        far.at = glm::dvec3(0, 2, -20);
        return edit::place_node(file, node("key"), far);
    });
    draw();
    point(xr::kRight, {0, 2, 0}, {0.4, 2, -20});
    draw();
    EXPECT_EQ(hit().target, headset::PointerHit::Target::kMarker);
}

}  // namespace
}  // namespace neuvv::test
