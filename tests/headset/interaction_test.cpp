#include "tools/headset/interaction.h"

#include "headset/hands_at_a_stage.h"
#include "tools/headset/arrange.h"

namespace neuvv::test {
namespace {

constexpr glm::dvec3 kMove(0.3, 0, -0.2);  // how far a hand moves

struct InteractionTest : HandsAtAStage {
    // The right hand points at `target`, grabs what its ray hits, and moves by kMove.
    void grab_and_move(glm::dvec3 target) {
        point(xr::kRight, kRightHand, target);
        inputs[xr::kRight].grab = 1;
        frame();
        for (int i = 1; i <= 4; ++i) {
            point(xr::kRight, kRightHand + 0.25 * i * kMove, target + 0.25 * i * kMove);
            frame();
        }
    }
    void release_grab() {
        inputs[xr::kRight].grab = 0;
        frames(2);
    }
};

TEST_F(InteractionTest, ATriggerSelectsWhatItPointsAtOnce) {
    select(kBen);
    EXPECT_EQ(state.editor.selected(), node("ben"));
    select(kAnna);
    EXPECT_EQ(state.editor.selected(), node("anna"));
    select({0, 5, -2});
    EXPECT_FALSE(state.editor.selected()) << "nothing was pointed at";
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(InteractionTest, AHeldPerformerGoesWithItsHandAndIsOneStep) {
    const glm::dvec3 before = position("ben");
    grab_and_move(kBen);
    EXPECT_TRUE(interaction.grab.is_active());
    EXPECT_FALSE(state.editor.modified()) << "while it is held";
    EXPECT_LT(glm::distance(position("ben"), before + kMove), 1e-9) << "but it is seen there";
    release_grab();
    EXPECT_LT(glm::distance(position("ben"), before + kMove), 1e-9);
    EXPECT_LT(glm::distance(position("anna"), kAnna - glm::dvec3(0.8, 0.8, 0.8)), 1e-9) << "the other stays";
    EXPECT_EQ(undo_all(), 1u);
    frame();
    EXPECT_LT(glm::distance(position("ben"), before), 1e-9);
}

TEST_F(InteractionTest, UndoWhileItIsHeldTakesTheMoveBack) {
    const glm::dvec3 before = position("ben");
    grab_and_move(kBen);
    inputs[xr::kLeft].undo = true;
    frames(2);
    EXPECT_FALSE(interaction.grab.is_active());
    EXPECT_LT(glm::distance(position("ben"), before), 1e-9);
    release_grab();
    EXPECT_LT(glm::distance(position("ben"), before), 1e-9) << "letting go of nothing moves nothing";
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(InteractionTest, UndoOfNothingIsRefused) {
    inputs[xr::kLeft].undo = true;
    frame();
    EXPECT_TRUE(was_notified("nothing to undo"));
    EXPECT_EQ(interaction.hands[xr::kLeft].vibration, 0) << "which would say that it was done";
}

TEST_F(InteractionTest, ACopyOfWhatIsHeldStandsWhereItWasPut) {
    const glm::dvec3 before = position("ben");
    grab_and_move(kBen);
    inputs[xr::kRight].duplicate = true;
    frames(2);
    EXPECT_LT(glm::distance(position("ben"), before + kMove), 1e-9);
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.selected_performer(), 2u) << "the copy is selected";
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(InteractionTest, PlayAndPauseAreFelt) {
    for (const bool plays : {true, false}) {
        inputs[xr::kRight].play = true;
        frame();
        EXPECT_EQ(state.clock.playing, plays);
        EXPECT_GT(interaction.hands[xr::kRight].vibration, 0);
        EXPECT_EQ(interaction.hands[xr::kLeft].vibration, 0);
        frame();
        EXPECT_EQ(interaction.hands[xr::kRight].vibration, 0);
    }
}

TEST_F(InteractionTest, WhatIsLockedIsNotTaken) {
    state.editor.edit([&](edit::Document& document) { return edit::lock_node(document.file, node("ben"), true); });
    const glm::dvec3 before = position("ben");
    frame();
    grab_and_move(kBen);
    EXPECT_FALSE(interaction.grab.is_active());
    release_grab();
    EXPECT_EQ(position("ben"), before);
    EXPECT_TRUE(was_notified("locked"));
    select(kBen);
    headset::delete_selected(state);
    frame();
    EXPECT_EQ(state.stage->performers.size(), 2u);
    EXPECT_TRUE(was_notified("locked"));
}

TEST_F(InteractionTest, WhatIsScaledKeepsItsFeetOnTheFloor) {
    for (const double wider : {0.8, 0.3}) {
        point(xr::kRight, {1.05, 1.2, -0.3}, {1.05, 0.8, -2});
        point(xr::kLeft, {0.55, 1.2, -0.3}, {0.55, 0.8, -2});
        inputs[xr::kRight].grab = inputs[xr::kLeft].grab = 1;
        frames(2);
        ASSERT_TRUE(interaction.grab.is_grabbing(xr::kLeft) && interaction.grab.is_grabbing(xr::kRight));
        for (int i = 1; i <= 8; ++i) {
            const double half = 0.5 * glm::mix(0.5, wider, i / 8.0);
            point(xr::kRight, {0.8 + half, 1.2, -0.3}, {0.8 + half, 0.8, -2});
            point(xr::kLeft, {0.8 - half, 1.2, -0.3}, {0.8 - half, 0.8, -2});
            frame();
        }
        inputs[xr::kLeft].grab = 0;
        frame();
        release_grab();
        EXPECT_NEAR(state.evaluated.pose.world_from_node[node("ben")][0].x, 1.6 * wider / 0.5, 0.1);
        EXPECT_NEAR(position("ben").y, 0, 1e-9) << wider;
        state.editor.undo();
        frames(2);
    }
}

TEST_F(InteractionTest, WhatIsLiftedStaysThereAndWhatIsSunkComesUp) {
    const glm::dvec3 before = position("ben");
    for (const double by_m : {0.5, 0.1, -0.5}) {
        const glm::dvec3 moved(0.4, by_m, 0);
        point(xr::kRight, kRightHand, kBen);
        inputs[xr::kRight].grab = 1;
        frames(2);
        point(xr::kRight, kRightHand + moved, kBen + moved);
        frames(2);
        release_grab();
        const double stands_m = by_m > 0.2 ? by_m : 0;  // near the floor, on it
        EXPECT_LT(glm::distance(position("ben"), before + glm::dvec3(0.4, stands_m, 0)), 1e-9) << by_m;
        state.editor.undo();
        frames(2);
    }
    interaction.grab.settings.snaps_to_floor = false;
    point(xr::kRight, kRightHand, kBen);
    inputs[xr::kRight].grab = 1;
    frames(2);
    point(xr::kRight, kRightHand - glm::dvec3(0, 0.1, 0), kBen - glm::dvec3(0, 0.1, 0));
    frames(2);
    release_grab();
    EXPECT_NEAR(position("ben").y, -0.1, 1e-9) << "where it is asked not to";
}

TEST_F(InteractionTest, WhatIsHeldTurnsAndMovesInSteps) {
    interaction.grab.settings.steps_heading = interaction.grab.settings.steps_place = true;
    point(xr::kRight, kRightHand, kBen);
    inputs[xr::kRight].grab = 1;
    frame();
    const xr::Pose start = *inputs[xr::kRight].aim;
    for (int i = 1; i <= 20; ++i) {
        inputs[xr::kRight].aim = xr::Pose{start.position + 0.03 * i * glm::dvec3(1, 0, -0.5),
                                          xr::turn_by(glm::radians(2.0 * i)) * start.rotation};
        frame();
        const glm::dmat4 seen = state.evaluated.pose.world_from_node[node("ben")];
        const double heading = std::atan2(seen[2].x, seen[2].z);
        EXPECT_NEAR(std::remainder(heading, headset::kHeadingStep_rad), 0, 1e-9) << "while it is held";
        EXPECT_NEAR(std::remainder(seen[3].x, headset::kPlaceStep_m), 0, 1e-9);
        EXPECT_NEAR(std::remainder(seen[3].z, headset::kPlaceStep_m), 0, 1e-9);
    }
    const glm::dmat4 held = state.evaluated.pose.world_from_node[node("ben")];
    EXPECT_NEAR(std::atan2(held[2].x, held[2].z), glm::radians(45.0), 1e-9) << "40° are nearest to 45°";
    release_grab();
    const glm::dmat4 now = state.evaluated.pose.world_from_node[node("ben")];
    EXPECT_LT(glm::distance(glm::dvec2(now[3].x, now[3].z), glm::dvec2(held[3].x, held[3].z)), 1e-9);
    EXPECT_LT(glm::distance(now[2], held[2]), 1e-9) << "and when it is let go";
}

TEST_F(InteractionTest, LeftHandedUsersHaveTheRolesOfTheOtherHand) {
    inputs[xr::kRight].stick = {1, 0};
    frame();
    EXPECT_LT(state.rig.yaw_rad, 0) << "the right stick turns the user";
    inputs[xr::kRight].stick = {0, 0};
    state.rig = {};
    frame();
    state.left_handed = true;
    inputs[xr::kRight].stick = {1, 0};
    frame();
    EXPECT_EQ(state.rig.yaw_rad, 0);
    inputs[xr::kLeft].stick = {1, 0};
    frame();
    EXPECT_LT(state.rig.yaw_rad, 0) << "now the left one does";
    EXPECT_LT(glm::distance(interaction.hands[xr::kRight].aim->position, kLeftHand), 0.5) << "it paints, too";
    inputs[xr::kLeft].stick = inputs[xr::kRight].stick = {0, 0};
    state.rig = {};
    point(xr::kLeft, kLeftHand, kAnna);
    inputs[xr::kLeft].select = 1;
    frame();
    EXPECT_EQ(state.editor.selected(), node("anna")) << "rays belong to hands";
    EXPECT_GT(interaction.hands[xr::kRight].vibration, 0);
    EXPECT_EQ(state.hand_of(xr::kRight), xr::kLeft);
}

TEST_F(InteractionTest, AHandThatIsNotSeenHoldsWhereItWasLast) {
    const glm::dvec3 before = position("ben");
    grab_and_move(kBen);
    inputs[xr::kRight].aim.reset();
    inputs[xr::kRight].grip.reset();
    frames(5);
    EXPECT_TRUE(interaction.grab.is_active());
    EXPECT_LT(glm::distance(position("ben"), before + kMove), 1e-9);
    release_grab();
    EXPECT_LT(glm::distance(position("ben"), before + kMove), 1e-9);
    EXPECT_EQ(undo_all(), 1u);

    frame();
    grab_and_move(kBen);
    inputs[xr::kRight].aim.reset();
    inputs[xr::kRight].grip.reset();
    frames(3);
    point(xr::kRight, kRightHand + 2.0 * kMove, kBen + 2.0 * kMove);
    frames(2);
    release_grab();
    EXPECT_LT(glm::distance(position("ben"), before + 2.0 * kMove), 1e-9) << "it goes on with a hand that comes back";
}

TEST_F(InteractionTest, APressOnNothingThatEndedDuringAnEditDeselectsNothingLater) {
    select(kBen);
    point(xr::kRight, kRightHand, {0, 5, -2});
    inputs[xr::kRight].select = 1;
    frame();
    inputs[xr::kRight].select = 0;
    inputs[xr::kLeft].duplicate = true;
    frames(2);
    select(kAnna);
    frames(2);
    EXPECT_EQ(state.editor.selected(), node("anna"));
}

TEST_F(InteractionTest, APoseThatIsNoneIsNoHand) {
    inputs[xr::kRight].aim->position.x = std::numeric_limits<double>::quiet_NaN();
    inputs[xr::kRight].select = inputs[xr::kRight].grab = 1;
    frames(3);
    EXPECT_FALSE(interaction.grab.is_active());
    EXPECT_FALSE(state.editor.selected());
}

TEST_F(InteractionTest, TheOtherHandDoesNotTakeAnotherPerformerMeanwhile) {
    grab_and_move(kBen);
    point(xr::kLeft, kLeftHand, kAnna);
    inputs[xr::kLeft].grab = 1;
    frames(2);
    EXPECT_FALSE(interaction.grab.is_grabbing(xr::kLeft));
    release_grab();
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(InteractionTest, AStickThatPushesWhatIsHeldDoesNotTurnItsUser) {
    grab_and_move(kBen);
    const glm::dvec3 before = position("ben");
    inputs[xr::kRight].stick = {0, 1};
    frames(20);
    EXPECT_LT(position("ben").z, before.z - 0.1) << "it is pushed away";
    inputs[xr::kRight].stick = {1, 0};
    frames(3);
    EXPECT_EQ(state.rig.yaw_rad, 0);
    EXPECT_EQ(state.clock.speed, 1);
}

TEST_F(InteractionTest, AStickOnThePanelIsItsWheelAlone) {
    state.panel_visible = true;
    frame();
    ASSERT_TRUE(interaction.panel);
    point(xr::kRight, kRightHand, interaction.panel->point_at({0.5, 0.5}));
    frame();
    inputs[xr::kRight].stick = {0, 1};
    frame();
    EXPECT_EQ(interaction.panel_pointer().wheel, 1);
    EXPECT_EQ(state.clock.speed, 1);
}

TEST_F(InteractionTest, ThePanelGoesWithTheHandThatGripsIt) {
    state.panel_visible = true;
    frame();
    const glm::dvec3 before = interaction.panel->world_from_panel.position;
    point(xr::kRight, kRightHand, interaction.panel->point_at({0.5, 0.9}));
    inputs[xr::kRight].grab = 1;
    frame();
    const xr::Pose held = *inputs[xr::kRight].aim;
    inputs[xr::kRight].aim = inputs[xr::kRight].grip = xr::Pose{held.position + kMove, held.rotation};
    frame();
    EXPECT_LT(glm::distance(interaction.panel->world_from_panel.position, before + kMove), 1e-9);
    EXPECT_FALSE(interaction.grab.is_active()) << "what is behind it is not held";
    inputs[xr::kRight].grab = 0;
    frame();
    inputs[xr::kRight].aim = held;
    frame();
    EXPECT_LT(glm::distance(interaction.panel->world_from_panel.position, before + kMove), 1e-9) << "it was let go";
}

TEST_F(InteractionTest, BareHandsCallThePanelByALongPinchBesideAll) {
    select(kBen);
    inputs[xr::kLeft].lacks_menu = true;
    inputs[xr::kLeft].has_grab = false;
    point(xr::kLeft, kLeftHand, {-3, 3, 0});
    inputs[xr::kLeft].select = 1;
    frames(40);
    EXPECT_FALSE(interaction.panel) << "not yet";
    frames(40);
    EXPECT_TRUE(interaction.panel);
    EXPECT_EQ(state.editor.selected(), node("ben")) << "it is what the panel is for";
    frames(80);
    EXPECT_TRUE(interaction.panel) << "once for a pinch";
    inputs[xr::kLeft].select = 0;
    frame();
    inputs[xr::kLeft].select = 1;
    frames(80);
    EXPECT_FALSE(interaction.panel) << "the next one hides it";
    inputs[xr::kLeft].select = 0;
    frame();
    EXPECT_EQ(state.editor.selected(), node("ben"));
    inputs[xr::kLeft].select = 1;
    frames(3);
    inputs[xr::kLeft].select = 0;
    frame();
    EXPECT_FALSE(state.editor.selected()) << "a short one";
}

// The left hand throws a teleport's arc that lands where it points, at a point of the floor; the stick is let go after
// it was pushed in this direction.
struct TeleportTest : InteractionTest {
    void aim_at(glm::dvec3 floor_point) {
        double low = -1.5, high = 0.9;  // the elevation at which the arc lands there
        const glm::dvec3 across =
            glm::normalize(glm::dvec3(floor_point.x - kLeftHand.x, 0, floor_point.z - kLeftHand.z));
        const double wanted_m =
            glm::distance(glm::dvec2(floor_point.x, floor_point.z), glm::dvec2(kLeftHand.x, kLeftHand.z));
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            point(xr::kLeft, kLeftHand, kLeftHand + std::cos(middle) * across + glm::dvec3(0, std::sin(middle), 0));
            const auto arc = xr::teleport_arc(*inputs[xr::kLeft].aim, state.floor_m);
            const bool far = !arc.landing || glm::distance(glm::dvec2(arc.landing->x, arc.landing->z),
                                                           glm::dvec2(kLeftHand.x, kLeftHand.z)) > wanted_m;
            (far ? high : low) = middle;
        }
    }
    void teleport(glm::dvec3 floor_point, const std::vector<glm::dvec2>& sticks = {{0, 1}}) {
        aim_at(floor_point);
        for (const glm::dvec2& stick : sticks) {
            inputs[xr::kLeft].stick = stick;
            frames(2);
        }
        inputs[xr::kLeft].stick = {0, 0};
        frame();
    }
    xr::Pose head_now() const { return xr::world_from_tracking(state.rig) * head; }
};

TEST_F(TeleportTest, ItGoesBesideAPerformerAndNotIntoIt) {
    teleport({0.1, 0, -3.5});
    EXPECT_LT(glm::distance(head_now().position, glm::dvec3(0.1, head.position.y, -3.5)), 0.05) << "where it is free";
    EXPECT_EQ(interaction.locomotion.shade().fade, 1) << "out of black";
    frames(60);
    EXPECT_EQ(interaction.locomotion.shade().fade, 0);
    state.rig = {};
    frame();
    teleport(kBen - glm::dvec3(0.3, 0.8, 0));
    const glm::dvec3 at = head_now().position;
    const double outside = std::max(std::abs(at.x - kBen.x), std::abs(at.z - kBen.z));
    EXPECT_GT(outside, 0.8 + headset::kBesidePerformer_m - 0.01) << at.x << " " << at.z;
    const double outside_anna = std::max(std::abs(at.x - kAnna.x), std::abs(at.z - kAnna.z));
    EXPECT_GT(outside_anna, 0.8 + headset::kBesidePerformer_m - 0.01) << "nor into the next one";
}

TEST_F(TeleportTest, TheSticksDirectionIsTheHeadingAndStepsNoFrames) {
    const double time_s = state.clock.time_s();
    teleport({0.1, 0, -3.5}, {{0, 1}, {-0.7, 0.7}, {-1, 0}, {-0.3, 0.2}});
    EXPECT_NEAR(xr::yaw_of(head_now().rotation), glm::radians(90.0), 1e-6) << "to the left";
    EXPECT_LT(glm::distance(head_now().position, glm::dvec3(0.1, head.position.y, -3.5)), 0.05);
    EXPECT_EQ(state.clock.time_s(), time_s);
    teleport({0.1, 0, -3.5}, {{0, 1}, {0.3, 0.9}});
    EXPECT_NEAR(xr::yaw_of(head_now().rotation), glm::radians(90.0), 1e-6) << "nearly straight up turns nothing";
}

TEST_F(InteractionTest, SpeedsStepFromOneToTheNextAndStayInTheirRange) {
    const auto push = [&](double up) {
        inputs[xr::kRight].stick = {0, up};
        frame();
        inputs[xr::kRight].stick = {0, 0};
        frame();
    };
    push(1);
    EXPECT_EQ(state.clock.speed, 2);
    for (int i = 0; i < 5; ++i) push(1);
    EXPECT_EQ(state.clock.speed, 4);
    for (int i = 0; i < 5; ++i) push(-1);
    EXPECT_LT(state.clock.speed, 0) << "below the slowest it plays backwards";
    for (int i = 0; i < 9; ++i) push(-1);
    EXPECT_EQ(state.clock.speed, -2);
}

}  // namespace
}  // namespace neuvv::test
