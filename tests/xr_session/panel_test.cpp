// The panel as both eyes see it, hints at the buttons, and what it saves.
#include "golden/golden.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Panel : XrSession {
    static XrScript with_hands() {
        XrScript script;
        script.hand(0, "right", kRightHand, {3, 4, -4});
        script.hand(0, "left", kLeftHand, {-3, 4, -4});
        return script;
    }
};

TEST_F(Panel, BothEyesSeeAllOfIt) {
    XrScript script = with_hands();
    script.click(kReady, "left", "y/click");
    script.end(kReady + 6);
    const XrRun run = this->run(script);
    expect_clean(run);
    const glm::dvec3 head(0, 1.5, 0), ahead = glm::normalize(glm::dvec3(0, 1.2, -2) - head);
    ASSERT_GT(run.seen["panel"].size(), 10u);
    for (const auto& [name, at] : run.seen["panel"].items()) {
        const glm::dvec3 to_item = glm::normalize(item_position(at) - head);
        EXPECT_GT(glm::dot(to_item, ahead), std::cos(glm::radians(34.0))) << name << " is far from the view's middle";
    }
}

TEST_F(Panel, HintsNameTheButtons) {
    write_settings(R"({"hands": {"hints": true}})");
    XrScript script;
    script.hand(0, "right", {0.15, 1.3, -0.7}, {3, 4, -4});
    script.hand(0, "left", {-0.15, 1.3, -0.7}, {-3, 4, -4});
    script.save(kReady + 2);
    script.end(kReady + 4);
    const XrRun first = run(script);
    expect_clean(first);
    write_settings(R"({"hands": {"hints": false}})");
    const XrRun off = run(script);
    EXPECT_EQ(off.seen["hints"]["left"], json::array());
    EXPECT_FALSE(same_pixels(first.image(kReady + 2, "left"), off.image(kReady + 2, "left"), 64)) << "they are seen";
    EXPECT_EQ(first.seen["hints"]["right"],
              json::parse(R"(["Trigger: select, press, paint", "Squeeze: hold and move", "Thumbstick: turn, speed",
                              "A: play, pause", "B: copy"])"));
    EXPECT_EQ(first.seen["hints"]["left"],
              json::parse(R"(["Trigger: select, press", "Squeeze: hold and move", "Thumbstick: teleport, step",
                              "Y: panel", "X: undo"])"));
}

TEST_F(Panel, HintsFollowTheControllersAndTheHandsRoles) {
    write_settings(R"({"hands": {"leftHanded": true}})");
    XrScript script = with_hands();
    script.json["profile"] = "/interaction_profiles/htc/vive_controller";
    script.end(kReady + 4);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(run.seen["hints"]["left"], json::parse(R"(["Trigger: select, press, paint", "Squeeze: hold and move",
                                                         "Trackpad: turn, speed", "Menu: panel"])"));
    EXPECT_EQ(run.seen["hints"]["right"], json::parse(R"(["Trigger: select, press", "Squeeze: hold and move",
                                                          "Trackpad: teleport, step", "Menu: play, pause"])"));
}

TEST_F(Panel, ItSavesUnderTheNextNumber) {
    XrScript script = with_hands();
    script.click(kReady, "left", "y/click");
    const json performer_page = panel_after(script, kReady + 6);
    press(script, 10, performer_page, "stage page");
    const json stage_page = panel_after(script, 10 + kPress + 2);
    press(script, 10 + kPress, stage_page, "save as");
    script.end(10 + 2 * kPress + 6);
    const XrRun run = this->run(script);
    expect_clean(run);
    const std::filesystem::path copy = folder.path / "stage-2.gltf";
    EXPECT_TRUE(std::filesystem::exists(copy)) << run.log;
    EXPECT_NE(run.log.find("saved " + copy.string()), std::string::npos) << run.log;
}

}  // namespace
}  // namespace neuvv::test
