// Where the user stands when a session begins, and after the tracking space has changed.
#include "tools/headset/standing.h"

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

struct StandingTest : HandsAtAStage {
    StandingTest() {
        state.rig = {{3, 0, -2}, 0.7};
        before = {{0.3, 1.6, 0.5}, xr::turn_by(0.4)};
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

TEST_F(StandingTest, TheFirstPlaceIsBelowTheCameraAndOneReturnsThere) {
    const headset::StandingPlace place = headset::first_place(state);
    const stage::EvaluatedCamera& camera = state.evaluated.cameras.at(0);
    EXPECT_NEAR(place.floor_point.x, camera.world_from_camera[3].x, 1e-9);
    EXPECT_NEAR(place.floor_point.z, camera.world_from_camera[3].z, 1e-9);
    EXPECT_EQ(place.floor_point.y, state.floor_m);
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
    EXPECT_LT(glm::length(to_panel), 1);
    EXPECT_GT(glm::dot(glm::normalize(to_panel), xr::forward_of(is)), std::cos(glm::radians(15.01)));
}

}  // namespace
}  // namespace neuvv::test
