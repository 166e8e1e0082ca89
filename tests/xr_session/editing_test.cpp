// Editing: what hands do to the stage, and what is saved.
#include "edit/recovery.h"
#include "golden/golden.h"
#include "support/figure.h"
#include "voctree/nvpaint.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Editing : XrSession {
    // Anna is selected by frame 9.
    static XrScript selecting() {
        XrScript script;
        script.hand(0, "right", kRightHand, kAnna);
        script.hand(0, "left", kLeftHand, {-3, 1, -4});
        script.click(kReady, "right", "trigger/value");
        return script;
    }
    // The same, and the panel is visible by frame 13.
    static XrScript with_panel() {
        XrScript script = selecting();
        script.click(kReady + 4, "left", "y/click");
        return script;
    }
    // The panel's items after with_panel(). One run serves all tests.
    const json& arrange_panel() {
        static const json items = panel_after(with_panel(), 18);
        return items;
    }
    // The panel's items on another page, which a script shows by pressing its item from frame 16 on.
    json page(const std::string& name) {
        XrScript script = with_panel();
        press(script, 16, arrange_panel(), name);
        return panel_after(script, 16 + kPress + 2);
    }
    // The end of a script: saves by the panel, which is visible.
    static void save(XrScript& script, int frame, const json& items) {
        press(script, frame, items, "save");
        script.end(frame + kPress + 6);
    }
    // The same, where the panel is hidden: it opens beside who is selected, wherever that is now.
    void show_and_save(XrScript& script, int frame) {
        script.click(frame, "left", "y/click");
        save(script, frame + 3, panel_after(script, frame + 6));
    }
};

TEST_F(Editing, AGripMovesAPerformerAndLettingGoIsOneStep) {
    XrScript script = selecting();
    const glm::dvec3 moved(0.4, 0.3, 0.2);
    script.input(12, "right", "squeeze/value", 1);
    script.hand(14, "right", kRightHand, kAnna);
    script.move_to(20, "right", kRightHand + moved, kAnna + moved);
    script.save(22);
    script.input(24, "right", "squeeze/value", 0);
    show_and_save(script, 26);
    const XrRun run = this->run(script);
    expect_clean(run);
    const glm::dvec3 was(-0.8, 0, -2.8);
    EXPECT_LT(glm::distance(position(node(saved(), "anna")), was + moved), 1e-3) << run.log;
    EXPECT_EQ(run.seen["modified"], false);
    EXPECT_EQ(check_golden("xr_grab", run.image(22, "left")), "");
    EXPECT_FALSE(run.report["haptics"].empty()) << "hands feel what they take";
}

TEST_F(Editing, TwoHandsScale) {
    XrScript script = selecting();
    // Points of the shoulders, which are alike on both sides of the head.
    const glm::dvec3 right(0.22, 0.3, -1.9), left(-0.38, 0.3, -1.9), up(0, 0.7, 1.5), apart(0.15, 0, 0);
    script.hand(11, "right", right + up, right);
    script.hand(11, "left", left + up, left);
    script.input(13, "right", "squeeze/value", 1);
    script.input(13, "left", "squeeze/value", 1);
    script.hand(15, "right", right + up, right);
    script.hand(15, "left", left + up, left);
    script.move_to(21, "right", right + up + apart, right + apart);
    script.move_to(21, "left", left + up - apart, left - apart);
    script.save(22);
    script.input(24, "right", "squeeze/value", 0);
    script.input(24, "left", "squeeze/value", 0);
    show_and_save(script, 26);
    const XrRun run = this->run(script);
    expect_clean(run);
    const json document = saved();
    const json& matrix = node(document, "anna")["matrix"];
    EXPECT_NEAR(matrix[0].get<double>(), 1.6 * 1.5, 0.01) << "from 0.6 m apart to 0.9 m";
    EXPECT_NEAR(matrix[5].get<double>(), 1.6 * 1.5, 0.01);
    EXPECT_EQ(check_golden("xr_scale", run.image(22, "right")), "");
}

TEST_F(Editing, ACopyStandsBesideAndIsTakenBack) {
    const size_t before = saved()["nodes"].size();
    XrScript script = selecting();
    script.click(12, "right", "b/click");
    script.save(16);
    show_and_save(script, 18);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_copy", run.image(16, "left")), "");
    EXPECT_EQ(saved()["nodes"].size(), before + 1);

    XrScript undone = selecting();
    undone.click(12, "right", "b/click");
    undone.click(16, "left", "x/click");
    undone.end(22);
    const XrRun second = this->run(undone);
    expect_clean(second);
    EXPECT_EQ(second.seen["modified"], false) << "taken back";
}

TEST_F(Editing, ThePanelRetimesSpinsAndTurnsShadowsOff) {
    const json& items = arrange_panel();
    const json stage_page = page("stage page");
    XrScript script = with_panel();
    int frame = 16;
    press(script, std::exchange(frame, frame + kPress), items, "time page");
    const json time = panel_after(script, frame + 4);
    for (const char* item : {"slower", "performer loop"})
        press(script, std::exchange(frame, frame + kPress), time, item);
    const glm::dvec3 spin = item_position(time["spin"]);
    script.hand(frame, "right", kRightHand, spin);
    script.input(frame + 2, "right", "trigger/value", 1);
    script.hand(frame + 4, "right", kRightHand, spin);
    script.move_to(frame + 8, "right", kRightHand, spin + glm::dvec3(0.06, 0, 0));
    script.input(frame + 10, "right", "trigger/value", 0);
    frame += 12;
    press(script, std::exchange(frame, frame + kPress), items, "stage page");
    for (const char* item : {"shadows", "falloff"})
        press(script, std::exchange(frame, frame + kPress), stage_page, item);
    script.save(frame);
    save(script, frame + 1, items);
    const XrRun run = this->run(script);
    expect_clean(run);
    const json document = saved();
    const json& performer = node(document, "anna")["extensions"]["NEUVV_performer"];
    EXPECT_EQ(performer["time"], json::parse(R"([{"operator": "speed", "factor": 0.5}, {"operator": "loop"}])"))
        << run.log;
    EXPECT_GT(performer["spin"], 20) << performer;
    EXPECT_LT(performer["spin"], 120) << performer;
    const json& settings = document["scenes"][0]["extensions"]["NEUVV_stage"];
    EXPECT_EQ(settings["shadows"], false);
    EXPECT_EQ(settings["falloff"], false);
    EXPECT_EQ(check_golden("xr_panel", run.image(frame, "left_seen")), "");
}

TEST_F(Editing, APerformerIsAddedAndABrokenClipIsTold) {
    std::filesystem::copy_file(clip, folder.path / "cleo.nvv");
    std::filesystem::copy_file(clip, folder.path / "dora.nvv");
    std::filesystem::resize_file(folder.path / "dora.nvv", std::filesystem::file_size(clip) / 2);
    const json& items = arrange_panel();
    const json stage_page = page("stage page");
    XrScript script = with_panel();
    script.json["time"] = "real";  // a thread reads the clips: it has seconds for each
    script.json["refresh_hz"] = 15;
    press(script, 16, items, "stage page");
    press(script, 24, stage_page, "add");
    const json clips = panel_after(script, 24 + kPress + 2);
    press(script, 32, clips, "clip dora.nvv");
    press(script, 62, stage_page, "add");
    press(script, 70, clips, "clip cleo.nvv");
    save(script, 200, items);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_NE(run.log.find("dora.nvv"), std::string::npos) << run.log;
    const json document = saved();
    EXPECT_THROW(node(document, "dora"), std::runtime_error);
    const glm::dvec3 cleo = position(node(document, "cleo")) + glm::dvec3(0.5, 0, 0.5);
    EXPECT_NEAR(cleo.z, -2, 0.6) << "before the user";
    EXPECT_GT(std::abs(cleo.x), 0.7) << "but not inside of anna, who stands there";
    EXPECT_LT(std::abs(cleo.x), 2);
}

TEST_F(Editing, ABrushInTheAirPaintsAndIsSaved) {
    XrScript to_paint = with_panel();
    const json& arrange = arrange_panel();
    press(to_paint, 14, arrange, "paint");
    const json paint = panel_after(to_paint, 28);
    XrScript script = to_paint;
    script.click(26, "left", "y/click");  // hides the panel
    const glm::dvec3 head(-0.08, 0.99, -1.62);
    script.head(27, {0, 1.5, 0}, {0, 1.2, -2});
    script.hand(30, "right", head + glm::dvec3(-0.1, 0, 0.08), head + glm::dvec3(-0.1, 0, -1));
    script.input(64, "right", "trigger/value", 1);
    script.hand(66, "right", head + glm::dvec3(-0.1, 0, 0.08), head + glm::dvec3(-0.1, 0, -1));
    script.move_to(74, "right", head + glm::dvec3(0.2, 0.1, 0.08), head + glm::dvec3(0.2, 0.1, -1));
    script.input(76, "right", "trigger/value", 0);
    script.save(99);
    script.click(101, "left", "y/click");
    save(script, 108, paint);
    const XrRun run = this->run(script);
    expect_clean(run);
    const json document = saved();
    const json layers = node(document, "anna")["extensions"]["NEUVV_performer"].value("paint", json::array());
    ASSERT_EQ(layers.size(), 1u) << run.log << run.seen;
    EXPECT_TRUE(std::filesystem::exists(folder.path / layers[0]["uri"].get<std::string>()));
    EXPECT_EQ(check_golden("xr_paint", run.image(99, "left")), "");
}

TEST_F(Editing, APictureIsProjectedAlongTheHand) {
    media::Image red(16, 8);
    for (size_t i = 0; i < red.rgba.size(); ++i) red.rgba[i] = i % 4 == 0 || i % 4 == 3 ? 255 : 0;
    media::write_png(folder.path / "red.png", red);
    XrScript to_paint = with_panel();
    press(to_paint, 14, arrange_panel(), "paint");
    const json paint = panel_after(to_paint, 28);
    XrScript script = to_paint;
    press(script, 26, paint, "picture");
    script.click(36, "left", "y/click");
    script.hand(40, "right", kRightHand, {-0.08, 0.99, -2});
    script.save(70);
    script.input(72, "right", "trigger/value", 1);
    script.input(75, "right", "trigger/value", 0);
    script.save(99);
    script.click(101, "left", "y/click");
    save(script, 108, paint);
    const XrRun run = this->run(script);
    expect_clean(run);
    const json document = saved();
    const json layers = node(document, "anna")["extensions"]["NEUVV_performer"].value("paint", json::array());
    ASSERT_EQ(layers.size(), 1u) << run.log << run.seen;
    const voctree::EditLayer layer =
        voctree::read_paint(folder.path / layers[0]["uri"].get<std::string>(), voctree::painted_field(figure_tree()));
    EXPECT_GT(layer.edits.size(), 5u);
    for (const voctree::LeafEdit& edit : layer.edits) EXPECT_LT(glm::distance(edit.colour, glm::vec3(1, 0, 0)), 0.01);
    EXPECT_EQ(check_golden("xr_picture", run.image(99, "left")), "");
    EXPECT_FALSE(same_pixels(run.image(70, "left"), run.image(99, "left")));
}

TEST_F(Editing, ABoxThatIsPulledUpIsErased) {
    XrScript to_region = with_panel();
    const json& arrange = arrange_panel();
    press(to_region, 14, arrange, "region");
    const json region = panel_after(to_region, 28);
    XrScript script = to_region;
    press(script, 22, region, "erase");
    script.click(32, "left", "y/click");
    const glm::dvec3 head(-0.08, 0.99, -2), hand = head + glm::dvec3(-0.5, 0, 0.58);
    script.hand(60, "right", hand, hand - glm::dvec3(0, 0, 1));
    script.input(62, "right", "trigger/value", 1);
    script.hand(64, "right", hand, hand - glm::dvec3(0, 0, 1));
    const glm::dvec3 last = hand + glm::dvec3(1, 0.5, -1.1);
    script.move_to(72, "right", last, last - glm::dvec3(0, 0, 1));
    script.input(74, "right", "trigger/value", 0);
    script.save(76);
    script.click(78, "left", "y/click");
    press(script, 84, region, "do region");
    script.click(124, "left", "y/click");
    script.save(128);
    script.end(132);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_region", run.image(76, "left")), "");
    EXPECT_EQ(check_golden("xr_erased", run.image(128, "left")), "");
    EXPECT_EQ(run.seen["modified"], true);
}

TEST_F(Editing, BareHandsPinchToSelectAndGrab) {
    XrScript script;
    script.json["profile"] = "/interaction_profiles/ext/hand_interaction_ext";
    script.json["hand_joints"] = true;
    script.hand(0, "right", kRightHand, kAnna);
    script.input(kReady, "right", "aim_activate_ext/value", 1);
    script.input(kReady + 3, "right", "aim_activate_ext/value", 0);
    script.save(kReady + 6);
    script.input(14, "right", "grasp_ext/value", 1);
    script.hand(16, "right", kRightHand, kAnna);
    script.move_to(22, "right", kRightHand + glm::dvec3(0.4, 0, 0), kAnna + glm::dvec3(0.4, 0, 0));
    script.input(26, "right", "grasp_ext/value", 0);
    script.end(30);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_NE(run.log.find("right hand: Bare hands"), std::string::npos) << run.log;
    EXPECT_EQ(check_golden("xr_bare_hand", run.image(kReady + 6, "left")), "");
    const auto kept = edit::find_recovery(folder.path / "state/neuvv/recovery", stage);
    ASSERT_EQ(kept.size(), 1u) << run.log;
    const json document = edit::restore(kept[0]).file.json.whole();
    EXPECT_LT(glm::distance(position(node(document, "anna")), glm::dvec3(-0.4, 0, -2.8)), 1e-3);
}

TEST_F(Editing, ControllersWithoutAGripHoldByALongTrigger) {
    XrScript script;
    script.json["profile"] = "/interaction_profiles/khr/simple_controller";
    script.hand(0, "right", kRightHand, kAnna);
    script.hand(0, "left", kLeftHand, {-3, 1, -4});
    script.input(kReady, "right", "select/click", 1);
    script.hand(50, "right", kRightHand, kAnna);
    script.move_to(58, "right", kRightHand + glm::dvec3(0.4, 0, 0), kAnna + glm::dvec3(0.4, 0, 0));
    script.input(62, "right", "select/click", 0);
    script.end(66);
    const XrRun run = this->run(script);
    expect_clean(run);
    const auto kept = edit::find_recovery(folder.path / "state/neuvv/recovery", stage);
    ASSERT_EQ(kept.size(), 1u) << run.log;
    const json document = edit::restore(kept[0]).file.json.whole();
    EXPECT_LT(glm::distance(position(node(document, "anna")), glm::dvec3(-0.4, 0, -2.8)), 1e-3);
}

TEST_F(Editing, AGripMovesThePanel) {
    const json items = panel_after(with_panel(), 14);
    XrScript script = with_panel();
    const glm::dvec3 on_panel = item_position(items["play"]), aside(-0.3, 0.1, 0);
    script.hand(14, "right", kRightHand, on_panel);
    script.input(16, "right", "squeeze/value", 1);
    script.hand(18, "right", kRightHand, on_panel);
    script.move_to(24, "right", kRightHand + aside, on_panel + aside);
    script.input(26, "right", "squeeze/value", 0);
    script.save(28);
    script.end(30);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_panel_moved", run.image(28, "left_seen")), "");
    EXPECT_LT(glm::distance(item_position(run.seen["panel"]["play"]), on_panel + aside), 1e-4);
    EXPECT_EQ(run.seen["modified"], false) << "the performer behind it stays";
}

}  // namespace
}  // namespace neuvv::test
