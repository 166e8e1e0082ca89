// Changes of the tracking space, and the way back to where the session began.
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Recentring : XrSession {
    static glm::dvec3 head_of(const XrRun& run) { return item_position(run.seen.at("head").at("at")); }
    static double heading_deg(const XrRun& run) { return run.seen.at("head").at("heading_deg"); }
    static json shift(glm::dvec3 at, double turn_deg) {
        return {{"shift", {{"at", {at.x, at.y, at.z}}, {"turn_deg", {0, turn_deg, 0}}}}};
    }
};

TEST_F(Recentring, AStageThatIsFoundAnewChangesNothingOfTheView) {
    XrScript script;
    script.json["profile"] = "";  // no hands in the image
    script.event(8, "recentre", shift({0.7, 0, 0.4}, 50));
    for (const int frame : {7, 9, 10, 11, 12, 18}) script.save(frame);
    script.end(20);
    const XrRun run = this->run(script);
    expect_clean(run);
    for (const int frame : {9, 10, 11, 12, 18})
        EXPECT_TRUE(same_pixels(run.image(7, "left"), run.image(frame, "left"))) << frame;
    EXPECT_NEAR(run.seen["turned_deg"].get<double>(), 50, 1e-3) << "the rig has followed";
}

TEST_F(Recentring, AUserWhoCentresTheViewStaysInPlaceAndLooksAhead) {
    for (const char* floor : {"local_floor", "local"}) {
        with_layer = std::string(floor) == "local";  // that of Debian 12 does not know LOCAL_FLOOR
        XrScript script;
        script.json["spaces"] = {"view", "local"};
        if (!with_layer) script.json["spaces"].push_back(floor);
        script.head(0, {0.5, 1.5, 0.3}, {-2, 1.5, 0.3});      // the user faces the left wall of the room
        script.head(kReady, {0.5, 1.5, 0.3}, {0.5, 1.5, 3});  // and then the one behind
        script.end(12);
        const XrRun before = run(script);
        script.event(8, "recentre", shift({0.5, 0, 0.3}, 180));  // where the user is and looks
        script.end(20);
        const XrRun after = run(script);
        expect_clean(before);
        expect_clean(after);
        EXPECT_LT(glm::distance(head_of(before), head_of(after)), 1e-3) << floor;
        EXPECT_GT(std::abs(heading_deg(before)), 80) << "of the stage's left or right";
        EXPECT_NEAR(heading_deg(after), 0, 1e-3) << "ahead is where the user looked first";
    }
}

// The user faces the left wall of the room, and then the one behind, and centres the view there: these spaces move.
XrScript centring(const std::vector<std::string>& moved, bool says_shift) {
    XrScript script;
    script.head(0, {0.5, 1.5, 0.3}, {-2, 1.5, 0.3});
    script.head(kReady, {0.5, 1.5, 0.3}, {0.5, 1.5, 3});
    json event = Recentring::shift({0.5, 0, 0.3}, 180);
    event["spaces"] = moved;
    event["says_shift"] = says_shift;
    script.event(8, "recentre", event);
    script.end(14);
    return script;
}

// STAGE stays where it is. The runtime may have LOCAL_FLOOR or not, and may say by how much that moves, or not.
TEST_F(Recentring, WhileStageStaysFixedTheUserLooksAhead) {
    for (const bool local_floor : {true, false}) {
        with_layer = !local_floor;
        XrScript script = centring({"local", "local_floor"}, !local_floor);
        if (local_floor) script.json["spaces"] = {"view", "local", "local_floor", "stage"};
        const XrRun run = this->run(script);
        expect_clean(run);
        EXPECT_LT(glm::distance(head_of(run), {0, 1.5, 0}), 1e-3) << "in the same place";
        EXPECT_NEAR(heading_deg(run), 0, 1e-3) << local_floor;
    }
}

// A runtime that recentres STAGE as well does not say by how much it moves.
TEST_F(Recentring, AStageThatMovesByAnUnknownPoseIsTheUsersWish) {
    const XrRun run = this->run(centring({"stage"}, false));
    expect_clean(run);
    EXPECT_LT(glm::distance(head_of(run), {0, 1.5, 0}), 1e-3);
    EXPECT_NEAR(heading_deg(run), 0, 1e-3);
}

// As Monado does with OXR_RECENTER_STAGE: the event comes a frame after the poses.
TEST_F(Recentring, AStageThatMovesBeforeItsEventLeavesTheUserInPlace) {
    XrScript script = centring({}, false);
    json moved = shift({0.5, 0, 0.3}, 180);
    moved["spaces"] = {"stage"};
    moved["silent"] = true;
    script.event(8, "recentre", moved);
    script.event(9, "recentre", {{"spaces", {"stage"}}, {"says_shift", false}});
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_LT(glm::distance(head_of(run), {0, 1.5, 0}), 1e-3);
    EXPECT_NEAR(heading_deg(run), 0, 1e-3);
}

// Performers stand in the user's own room, so recentring moves none of them.
TEST_F(Recentring, InTheUsersRoomNothingMoves) {
    XrScript script = centring({"local"}, true);
    script.json["blend_modes"] = {"opaque", "alpha_blend"};
    const XrRun run = this->run(script, {"--room"});
    expect_clean(run);
    EXPECT_LT(glm::distance(head_of(run), {0, 1.5, 0}), 1e-3);
    EXPECT_NEAR(std::abs(heading_deg(run)), 90, 1e-3) << "the user has turned from the left wall to the one behind";
}

// LOCAL is 1.7 m above the floor here; without LOCAL_FLOOR, 1.6 m are guessed.
TEST_F(Recentring, WithoutAStageTheFloorIsThatOfLocalFloor) {
    XrScript script;
    script.json["floor_m"] = -1.7;
    script.json["spaces"] = {"view", "local"};
    script.end(10);
    const XrRun guessed = run(script);
    with_layer = false;
    script.json["spaces"] = {"view", "local", "local_floor"};
    const XrRun known = run(script);
    script.json["extensions"] = {"XR_KHR_vulkan_enable2"};
    const XrRun without = run(script);
    expect_clean(known);
    EXPECT_NEAR(head_of(guessed).y, 1.4, 1e-3);
    EXPECT_NEAR(head_of(known).y, 1.5, 1e-3);
    EXPECT_NEAR(head_of(without).y, 1.4, 1e-3);
}

TEST_F(Recentring, ThePanelBringsTheUserBackToTheStart) {
    XrScript script;
    script.hand(0, "left", kLeftHand, {-0.2, 0, -1.5});
    script.hand(0, "right", kRightHand, {3, 1, 0});
    script.end(kReady + 2);
    const XrRun began = run(script);
    script.stick(kReady, "left", {0, 1});
    script.stick(10, "left", {0, 0});
    script.stick(12, "right", {1, 0});
    script.stick(14, "right", {0, 0});
    script.click(16, "left", "y/click");
    const json items = panel_after(script, 24);
    script.end(24);
    const XrRun away = run(script);
    press(script, 22, items, "user page");
    const json user_page = panel_after(script, 22 + kPress + 2);
    press(script, 22 + kPress, user_page, "to start");
    script.end(22 + 2 * kPress + 4);
    const XrRun back = run(script);
    expect_clean(back);
    EXPECT_GT(glm::distance(head_of(began), head_of(away)), 0.5);
    EXPECT_GT(std::abs(heading_deg(began) - heading_deg(away)), 20);
    EXPECT_LT(glm::distance(head_of(began), head_of(back)), 1e-6);
    EXPECT_NEAR(heading_deg(began), heading_deg(back), 1e-6);
}

}  // namespace
}  // namespace neuvv::test
