// The panel: where it opens, and where its rows are. It is drawn without a device.
#include "tools/headset/panel.h"

#include "headset/panel_at_a_stage.h"
#include "tools/headset/settings.h"

namespace neuvv::test {
namespace {

constexpr double kTiny = 1e-9;

double angle_between(glm::dvec3 a, glm::dvec3 b) {
    return std::acos(glm::clamp(glm::dot(glm::normalize(a), glm::normalize(b)), -1.0, 1.0));
}

double width_rad(const headset::PanelPlacement& panel, glm::dvec3 from) {
    return angle_between(panel.point_at({0, 0.5}) - from, panel.point_at({1, 0.5}) - from);
}

headset::PlacedBox box_at(glm::dvec3 middle, glm::dvec3 half) {
    return {glm::translate(glm::dmat4(1), middle), -half, half};
}

void expect_inside_the_view(const headset::PanelPlacement& panel, const xr::Pose& head) {
    const glm::dvec3 to_panel = panel.world_from_panel.position - head.position;
    EXPECT_LE(angle_between(xr::forward_of(head), to_panel), headset::kPanelAside_rad + kTiny);
    EXPECT_LE(glm::degrees(width_rad(panel, head.position)), 40);
    EXPECT_GE(width_rad(panel, head.position), headset::kMinPanelWidth_rad - kTiny) << "it can be read";
    EXPECT_NEAR(glm::length(to_panel), headset::kPanelAway_m, kTiny);
    EXPECT_LT(angle_between(panel.world_from_panel.rotation * glm::dvec3(0, 0, 1), -to_panel), 1e-6)
        << "it faces the head";
    EXPECT_NEAR((panel.world_from_panel.rotation * glm::dvec3(1, 0, 0)).y, 0, kTiny) << "it is level";
}

TEST(PanelPlacementTest, ItOpensInsideTheViewWhereverTheHeadLooks) {
    for (const double yaw : {-170.0, -30.0, 0.0, 75.0})
        for (const double pitch : {-70.0, -20.0, 0.0, 40.0})
            for (const double roll : {-25.0, 0.0}) {
                const xr::Pose head{{1, 1.5, 2},
                                    xr::turn_by(glm::radians(yaw)) *
                                        glm::angleAxis(glm::radians(pitch), glm::dvec3(1, 0, 0)) *
                                        glm::angleAxis(glm::radians(roll), glm::dvec3(0, 0, 1))};
                for (const bool left_handed : {false, true})
                    expect_inside_the_view(headset::panel_in_view(head, {}, left_handed), head);
                for (const double aside : {-1.5, -0.4, 0.0, 0.7})
                    expect_inside_the_view(
                        headset::panel_in_view(head, box_at(head * glm::dvec3(aside, 0, -2), {0.3, 0.8, 0.2}), false),
                        head);
            }
}

TEST(PanelPlacementTest, ItOpensBesideWhatItIsAboutWithoutCoveringIt) {
    const xr::Pose head{{0, 1.5, 0}, {1, 0, 0, 0}};
    for (int aside_cm = -230; aside_cm <= 230; aside_cm += 5) {
        const headset::PlacedBox box = box_at({0.01 * aside_cm, 0.8, -3}, {0.2, 0.8, 0.2});
        const auto seen = headset::seen_between(head, box);
        ASSERT_TRUE(seen) << aside_cm;
        const headset::PanelPlacement panel = headset::panel_in_view(head, box, false);
        const auto left_of = [&](double u) {
            const glm::dvec3 at = panel.point_at({u, 0.5}) - head.position;
            return std::atan2(-at.x, -at.z);
        };
        EXPECT_TRUE(left_of(0) < seen->first || left_of(1) > seen->second) << aside_cm << " cm aside: it is covered";
        const double apart = std::min(std::abs(seen->first - left_of(0)), std::abs(left_of(1) - seen->second));
        EXPECT_LT(glm::degrees(apart), 26) << "it is beside it";
        expect_inside_the_view(panel, head);
    }
}

TEST(PanelPlacementTest, WhatFillsTheViewIsCoveredAsLittleAsPossible) {
    const xr::Pose head{{0, 1.5, 0}, {1, 0, 0, 0}};
    for (const double aside_m : {-0.2, 0.2}) {
        const auto panel = headset::panel_in_view(head, box_at({aside_m, 0.8, -1.2}, {0.5, 0.8, 0.2}), false);
        EXPECT_NEAR(width_rad(panel, head.position), headset::kMinPanelWidth_rad, 1e-4);
        EXPECT_LT(panel.world_from_panel.position.x * aside_m, 0) << "on the side with more room";
    }
}

TEST(PanelPlacementTest, AboutNobodyItOpensAwayFromTheHandThatPoints) {
    const xr::Pose head{{0, 1.5, 0}, {1, 0, 0, 0}};
    EXPECT_LT(headset::panel_in_view(head, {}, false).world_from_panel.position.x, 0);
    EXPECT_GT(headset::panel_in_view(head, {}, true).world_from_panel.position.x, 0);
    const headset::PlacedBox behind = box_at({0, 0.8, 2}, {0.3, 0.8, 0.2});
    EXPECT_EQ(headset::panel_in_view(head, behind, false).world_from_panel.position,
              headset::panel_in_view(head, {}, false).world_from_panel.position)
        << "who is not seen does not matter";
}

using headset::HandTool, headset::PanelDialogue, headset::PanelPage;

// The panel's rows, and what they do.
struct PanelRows : PanelAtAStage {
    static constexpr auto kPages = {PanelPage::kPerformer, PanelPage::kTime, PanelPage::kCopies, PanelPage::kStage,
                                    PanelPage::kUser};
    std::map<std::string, glm::dvec2> items_with(std::optional<uint32_t> selected) {
        state.editor.select(selected);
        draw_settled();
        return items;
    }
};

TEST_F(PanelRows, NoRowMovesWhenSomebodyIsSelected) {
    for (const PanelPage page : kPages) {
        state.page = page;
        const auto nobody = items_with({}), ben = items_with(node("ben"));
        EXPECT_GT(nobody.size(), 10u);
        EXPECT_EQ(nobody, ben) << static_cast<int>(page);
    }
}

// In dmm: thousandths of the distance.
TEST_F(PanelRows, ItsTextCanBeReadAndFitsItsButtons) {
    const double line = ImGui::GetFontSize() / kWidth;  // of the panel's width
    EXPECT_GE(1000 * line * 2 * std::tan(headset::kMinPanelWidth_rad / 2), 20);
    const auto expect_fitting = [&](const char* where) {
        draw_settled();
        EXPECT_TRUE(cut_off.empty()) << where << ": " << cut_off.front();
    };
    for (const PanelPage page : kPages) {
        state.page = page;
        items_with(node("ben"));
        expect_fitting("a page");
    }
    for (const HandTool tool : {HandTool::kPaint, HandTool::kRegion, HandTool::kLights, HandTool::kCoach}) {
        state.tool = tool;
        expect_fitting("a tool");
    }
    state.tool = HandTool::kArrange;
    state.page = PanelPage::kPerformer;
    items_with(node("ben"));
    press("rename");
    expect_fitting("the keyboard");
}

TEST_F(PanelRows, WhoSitsIsRaisedAndTheSoundHasAVolume) {
    state.page = PanelPage::kUser;
    draw_settled();
    head.position.y = 1.2;
    press("seated");
    EXPECT_GT(state.comfort.raised_m, 0.3);
    EXPECT_NEAR(state.rig.position.y, state.comfort.raised_m, 1e-9);
    state.shows_room = true;
    frame();
    EXPECT_EQ(state.rig.position.y, 0) << "the user's own floor is where it is";
    state.shows_room = false;
    frame();
    press("seated");
    EXPECT_EQ(state.comfort.raised_m, 0);
    EXPECT_NEAR(state.rig.position.y, 0, 1e-9);
    drag("volume", {-0.2});
    EXPECT_LT(state.volume_percent, 100);
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(PanelRows, EveryItemIsOnThePanel) {
    for (const auto selected : {std::optional<uint32_t>(), std::optional(node("ben"))})
        for (const HandTool tool : {HandTool::kArrange, HandTool::kPaint, HandTool::kRegion, HandTool::kCoach})
            for (const PanelPage page : kPages) {
                state.tool = tool;
                state.page = page;
                double last_row = 0;
                for (const auto& [name, at] : items_with(selected)) {
                    EXPECT_TRUE(at.x > 0 && at.x < 1 && at.y > 0 && at.y < 1) << name << " " << at.x << " " << at.y;
                    last_row = std::max(last_row, at.y);
                }
                EXPECT_EQ(items.at("leave").y, last_row) << "other rows end above it";
            }
}

TEST_F(PanelRows, WhatNeedsASelectionDoesNothingWithoutOne) {
    const std::pair<PanelPage, std::vector<const char*>> pages[] = {
        {PanelPage::kPerformer, {"copy", "delete", "floor", "life size", "hide", "rename"}},
        {PanelPage::kTime,
         {"once", "performer loop", "to and fro", "freeze", "slower", "faster", "reverse", "earlier", "later", "offset",
          "spin"}},
        {PanelPage::kCopies, {"make copies"}}};
    for (const auto& [page, pressed] : pages) {
        state.page = page;
        draw_settled();
        for (const char* item : pressed) {
            press(item);
            EXPECT_FALSE(state.editor.modified()) << item;
        }
    }
    EXPECT_EQ(state.dialogue, PanelDialogue::kNone);
    EXPECT_TRUE(state.editor.take_notices().empty());
    for (const auto& [page, item] : {std::pair{PanelPage::kPerformer, "hide"},
                                     {PanelPage::kTime, "slower"},
                                     {PanelPage::kCopies, "make copies"}}) {
        state.page = page;
        items_with(node("ben"));
        press(item);
        EXPECT_EQ(steps(), 1u) << item;
    }
}

TEST_F(PanelRows, WhatWasDeletedComesBack) {
    select(kAnna);
    draw_settled();
    press("delete");
    EXPECT_EQ(state.stage->performers.size(), 1u);
    EXPECT_EQ(state.evaluated.performers.size(), 1u) << "she is not seen";
    inputs[xr::kLeft].undo = true;
    draw_settled();
    EXPECT_EQ(state.evaluated.performers.size(), 2u);
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(PanelRows, APressThatBeganElsewherePressesNothing) {
    select(kAnna);
    state.panel_visible = true;
    draw_settled();
    const glm::dvec3 on_delete = interaction.panel->point_at(items.at("delete"));
    for (const bool began_elsewhere : {true, false}) {
        point(xr::kRight, kRightHand, began_elsewhere ? glm::dvec3(3, 1, 0) : on_delete);
        draw_by_hand();
        inputs[xr::kRight].select = 1;
        draw_by_hand();
        point(xr::kRight, kRightHand, on_delete);
        for (int i = 0; i < 3; ++i) draw_by_hand();
        inputs[xr::kRight].select = 0;
        for (int i = 0; i < 3; ++i) draw_by_hand();
        EXPECT_EQ(state.editor.modified(), !began_elsewhere);
        select(kAnna);
    }
}

TEST_F(PanelRows, ComfortIsRememberedFromRunToRun) {
    const auto turned_by_little_deg = [&] {  // too little for a snap turn
        state.rig = {};
        inputs[xr::kRight].stick = {0.5, 0};
        frames(18);
        inputs[xr::kRight].stick = {0, 0};
        frame();
        return glm::degrees(state.rig.yaw_rad);
    };
    EXPECT_EQ(turned_by_little_deg(), 0);
    headset::HeadsetSettings settings(folder.path / "config/headset.json");
    settings.load(state, interaction.grab.settings);
    press("user page");
    press("smooth turn");
    press("smooth walk");
    settings.save(state, interaction.grab.settings);
    state.comfort = {};
    headset::HeadsetSettings(folder.path / "config/headset.json").load(state, interaction.grab.settings);
    EXPECT_TRUE(state.comfort.smooth_walk);
    EXPECT_LT(turned_by_little_deg(), -5);
}

TEST_F(PanelRows, AKeyboardRenamesWhoIsSelected) {
    state.editor.select(node("ben"));
    draw_settled();
    press("rename");
    ASSERT_EQ(state.dialogue, PanelDialogue::kKeyboard);
    EXPECT_EQ(state.typed, "ben");
    for (int i = 0; i < 3; ++i) press("key back");
    for (const char* key : {"key e", "key v", "key a", "key space", "key 2"}) press(key);
    EXPECT_EQ(state.typed, "Eva 2");
    for (const auto& [name, at] : items) EXPECT_TRUE(at.x > 0 && at.x < 1) << name;
    press("key done");
    EXPECT_EQ(state.dialogue, PanelDialogue::kNone);
    draw();
    EXPECT_EQ(state.stage->performers[1].name, "Eva 2");
    press("rename");
    press("key back");
    press("key cancel");
    EXPECT_EQ(state.stage->performers[1].name, "Eva 2");
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(PanelRows, TheKeyboardGoesWhenSomebodyElseIsSelected) {
    items_with(node("ben"));
    press("rename");
    press("key x");
    ASSERT_EQ(state.dialogue, PanelDialogue::kKeyboard);
    items_with(node("anna"));
    EXPECT_EQ(state.dialogue, PanelDialogue::kNone);
    EXPECT_FALSE(has("key done"));
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(PanelRows, ASliderThatIsNoLongerShownEndsItsEdit) {
    const auto hold = [&](const char* item) {
        state.page = PanelPage::kTime;
        state.panel_visible = true;
        items_with(node("ben"));
        const glm::dvec2 at = items.at(item);
        draw(at);
        draw(at, true);
        draw(at + glm::dvec2(0.1, 0), true);
        EXPECT_TRUE(state.editor.dragging());
    };
    const auto expect_ended = [&] {
        EXPECT_FALSE(state.editor.dragging());
        draw_settled();
        EXPECT_EQ(steps(), 1u);
    };
    hold("spin");
    state.page = PanelPage::kPerformer;  // the other hand pressed the page's button
    draw(glm::dvec2(0.5), true);
    expect_ended();
    hold("offset");
    state.panel_visible = false;  // so nothing is drawn
    frame();
    expect_ended();
    hold("spin");
    interaction.release_all(state);
    expect_ended();
}

TEST_F(PanelRows, TheStagePageAddsAndShowsPerformers) {
    items_with(node("ben"));
    press("hide");
    press("stage page");
    press("show ben");
    EXPECT_EQ(state.editor.selected(), node("ben"));
    press("add");
    press("clip figure.nvv");
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.dialogue, PanelDialogue::kNone);
    EXPECT_EQ(undo_all(), 3u);
}

TEST_F(PanelRows, ClipsOfTheSameNameAreApart) {
    const std::filesystem::path other = folder.path / "other/figure.nvv";
    std::filesystem::create_directories(other.parent_path());
    std::filesystem::copy_file(clip, other);
    press("stage page");
    press("add");
    state.clips = {clip, other};
    draw_settled();
    press("clip figure.nvv");  // the position of the last one
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.stage->clips[state.stage->performers[2].clip].path, other);
}

TEST_F(PanelRows, ItOpensBesideWhoIsSelected) {
    select(kBen);
    inputs[xr::kLeft].menu = true;
    frame();
    ASSERT_TRUE(interaction.panel);
    expect_inside_the_view(*interaction.panel, head);
    EXPECT_LT(interaction.panel->point_at({1, 0.5}).x, 0) << "ben's box begins at the middle of the view";
    select(kAnna);
    EXPECT_LT(interaction.panel->point_at({1, 0.5}).x, 0) << "it stays where it is";
    inputs[xr::kLeft].menu = true;
    frame();
    inputs[xr::kLeft].menu = true;
    frame();
    EXPECT_GT(interaction.panel->point_at({0, 0.5}).x, 0) << "it opens beside anna";
}

}  // namespace
}  // namespace neuvv::test
