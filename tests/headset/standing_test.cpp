// Where the user stands when a session begins, and after the tracking space has changed.
#include "tools/headset/standing.h"

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

struct StandingTest : HandsAtAStage {
    StandingTest() {
        state.rig = {{3, 0, -2}, 0.7};
        before = {{0.3, 1.6, 0.5}, xr::turn_by(0.4)};
        const auto leaves = std::make_shared<const voctree::SolidLeaves>(figure_tree());
        state.solid.assign(state.stage->performers.size(), editor::SolidPart(leaves, 0));
    }
    // The head in the world, after the tracking space has moved by `shift`, which is the new one in the old one.
    xr::Pose head_after(const xr::Pose& shift, bool by_user, bool is_known) {
        xr::TrackingChange change{0, {}, by_user};
        if (is_known) change.old_from_new = shift;
        const xr::Pose now = xr::inverse(shift) * before;
        headset::follow_tracking_change(state, change, before, now);
        return xr::world_from_tracking(state.rig) * now;
    }
    xr::Pose before;
};

TEST_F(StandingTest, WhereTheSystemMovesTheSpaceNothingOfTheViewChanges) {
    const xr::XrRig rig = state.rig;
    const xr::Pose shift{{0.6, 0, -0.9}, xr::turn_by(1.1)}, was = xr::world_from_tracking(rig) * before;
    for (const bool is_known : {true, false}) {
        state.rig = rig;
        const xr::Pose is = head_after(shift, false, is_known);
        EXPECT_LT(glm::distance(is.position, was.position), 1e-9) << is_known;
        EXPECT_NEAR(xr::yaw_of(is.rotation), xr::yaw_of(was.rotation), 1e-9) << is_known;
        EXPECT_GT(std::abs(state.rig.yaw_rad - rig.yaw_rad), 0.5) << "the rig has followed";
    }
}

TEST_F(StandingTest, AFloorThatIsFoundAnewIsTheFloorOfTheStage) {
    const xr::Pose is = head_after({{0, -0.1, 0}, {1, 0, 0, 0}}, false, true);
    EXPECT_EQ(state.rig.position.y, 0);
    EXPECT_NEAR(is.position.y, 1.7, 1e-9) << "the user is as high above the floor as the runtime says";
}

TEST_F(StandingTest, AUserWhoCentresTheSpaceStaysThereAndLooksAhead) {
    headset::stand_at(state, {{1, 0, 2}, 0.2}, before);
    interaction.locomotion.update(state, interaction.hands, {true, true}, before, 0.01);
    interaction.hands[xr::kRight].flick.update({1, 0});
    interaction.locomotion.update(state, interaction.hands, {true, true}, before, 0.01);
    const xr::Pose was = xr::world_from_tracking(state.rig) * before;
    before.rotation = xr::turn_by(0.9) * before.rotation;  // the user turns, and centres the space there
    const xr::Pose is = head_after({{0.3, 0, 0.5}, xr::turn_by(1.3)}, true, true);
    EXPECT_LT(glm::distance(is.position, was.position), 1e-9);
    EXPECT_NEAR(xr::yaw_of(is.rotation), 0.2 - glm::radians(30.0), 1e-9) << "the start's heading, and a snap turn";
}

// The distance on the floor to the centre of what is solid of anna or ben, whoever is nearer.
double to_nearest(glm::dvec3 at) {
    double nearest_m = INFINITY;
    for (glm::dvec3 centre : {kAnna, kBen}) {
        centre.x += 1.6 * (kHead.x - 0.5);
        nearest_m = std::min(nearest_m, glm::distance(glm::dvec2(at.x, at.z), glm::dvec2(centre.x, centre.z)));
    }
    return nearest_m;
}

TEST_F(StandingTest, TheFirstPlaceIsNearThePerformersAndAsTheCameraLooks) {
    stage::EvaluatedCamera& camera = state.evaluated.cameras.at(0);
    const auto at = [&](glm::dvec3 position, double yaw_rad) {
        camera.world_from_camera = xr::matrix_of({position, xr::turn_by(yaw_rad)});
        return headset::first_place(state);
    };
    for (const double away_m : {8.0, 3.0, 0.5, -0.5}) {
        const headset::StandingPlace place = at({0.8, 1.5, kBen.z + away_m}, 0);
        EXPECT_GE(to_nearest(place.floor_point), 2 - 0.02) << away_m;
        EXPECT_LE(to_nearest(place.floor_point), 2.5 + 0.02) << away_m;
        EXPECT_NEAR(place.floor_point.x, 0.8, 1e-9) << "ahead of the camera or behind it";
        EXPECT_EQ(place.floor_point.y, state.floor_m);
        EXPECT_EQ(place.yaw_rad, 0) << "with its heading";
    }
    const headset::StandingPlace below = at({0.8, 1.5, kBen.z + 2.2}, 0);
    EXPECT_NEAR(below.floor_point.z, kBen.z + 2.2, 1e-9) << "there already";
}

TEST_F(StandingTest, WhereTheCameraLooksAtNobodyOneFacesTheNearest) {
    stage::EvaluatedCamera& camera = state.evaluated.cameras.at(0);
    camera.world_from_camera = xr::matrix_of({{9, 2, -2}, xr::turn_by(2.5)});
    const headset::StandingPlace place = headset::first_place(state);
    EXPECT_GE(to_nearest(place.floor_point), 2 - 0.02);
    EXPECT_LE(to_nearest(place.floor_point), 2.5 + 0.02);
    const glm::dvec3 ahead = xr::turn_by(place.yaw_rad) * glm::dvec3(0, 0, -1);
    const glm::dvec3 to_ben = glm::normalize(glm::dvec3(kBen.x, 0, kBen.z) - place.floor_point);
    EXPECT_GT(glm::dot(ahead, to_ben), 0.99);
    state.evaluated.cameras.clear();
    const headset::StandingPlace without = headset::first_place(state);
    EXPECT_GE(to_nearest(without.floor_point), 2 - 0.02) << "without a camera, before them";
    EXPECT_LE(to_nearest(without.floor_point), 2.5 + 0.02);
    EXPECT_GT(without.floor_point.z, kBen.z);
}

TEST_F(StandingTest, OneReturnsToTheFirstPlace) {
    const headset::StandingPlace place = headset::first_place(state);
    headset::stand_at(state, place, before);
    const xr::Pose is = xr::world_from_tracking(state.rig) * before;
    EXPECT_LT(glm::distance(is.position, place.floor_point + glm::dvec3(0, before.position.y, 0)), 1e-9);
    EXPECT_NEAR(xr::yaw_of(is.rotation), place.yaw_rad, 1e-9);
}

TEST_F(StandingTest, WhatHandsHoldIsLetGoAndThePanelComesAlong) {
    state.rig = {};
    state.panel_visible = true;
    point(xr::kRight, kRightHand, kBen);
    inputs[xr::kRight].grab = 1;
    frames(2);
    ASSERT_TRUE(interaction.grab.is_active());
    state.rig.position = {0, 0, 5};
    interaction.user_was_moved(state);
    EXPECT_FALSE(interaction.grab.is_active());
    frame();
    const xr::Pose is = xr::world_from_tracking(state.rig) * head;
    const glm::dvec3 to_panel = interaction.panel->world_from_panel.position - is.position;
    EXPECT_LT(glm::length(to_panel), 1.2);
    EXPECT_GT(glm::dot(glm::normalize(to_panel), xr::forward_of(is)),
              std::cos(headset::kPanelAside_rad + glm::radians(0.01)));
}

}  // namespace
}  // namespace neuvv::test
