// The panel: where it opens, and where its rows are. It is drawn without a device.
#include "tools/headset/panel.h"

#include <imgui.h>

#include "headset/hands_at_a_stage.h"
#include "tools/headset/training.h"
#include "tools/ui/theme.h"

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
    EXPECT_LE(glm::degrees(angle_between(xr::forward_of(head), to_panel)), 15 + kTiny);
    EXPECT_LE(glm::degrees(width_rad(panel, head.position)), 40);
    EXPECT_GE(glm::degrees(width_rad(panel, head.position)), 20 - kTiny) << "it can be read";
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
        EXPECT_NEAR(glm::degrees(width_rad(panel, head.position)), 20, 0.01);
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

// The panel's rows, drawn by ImGui without a device.
struct PanelRows : HandsAtAStage {
    PanelRows() {
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        ui::apply_theme(1.75f);
        ImGui::GetIO().Fonts->Build();
    }
    ~PanelRows() override { ImGui::DestroyContext(); }
    // Draws the panel, as often as its layout needs. The right hand presses `item` in between, where it is given.
    headset::PanelResult draw(const std::string& item = "") {
        headset::PanelResult result;
        for (int i = 0; i < 5; i++) {
            ImGuiIO& io = ImGui::GetIO();
            io.DisplaySize = {768, 1024};
            io.DeltaTime = 1.0f / 90;
            io.MouseDown[0] = i == 2 && !item.empty();
            io.MousePos = {-FLT_MAX, -FLT_MAX};
            if (!item.empty() && i > 0) {
                const glm::dvec2 at = result.items.at(item);
                io.MousePos = {static_cast<float>(768 * at.x), static_cast<float>(1024 * at.y)};
            }
            ImGui::NewFrame();
            const auto before = result;
            result = headset::draw_panel(state, interaction, training, {});
            result.save |= before.save;
            ImGui::EndFrame();
            frame();
        }
        return result;
    }
    headset::Training training = headset::Training(jobs);
};

TEST_F(PanelRows, NoRowMovesWhenSomebodyIsSelected) {
    for (const auto page : {headset::PanelPage::kPerformer, headset::PanelPage::kStage, headset::PanelPage::kUser}) {
        state.page = page;
        state.editor.select({});
        const headset::PanelResult nobody = draw();
        state.editor.select(node("ben"));
        const headset::PanelResult ben = draw();
        EXPECT_GT(nobody.items.size(), 10u);
        EXPECT_EQ(nobody.items, ben.items);
    }
}

TEST_F(PanelRows, EveryItemIsOnThePanel) {
    for (const auto tool : {headset::HandTool::kArrange, headset::HandTool::kPaint, headset::HandTool::kRegion,
                            headset::HandTool::kTrain})
        for (const auto page :
             {headset::PanelPage::kPerformer, headset::PanelPage::kStage, headset::PanelPage::kUser}) {
            state.tool = tool;
            state.page = page;
            double last_row = 0;
            const headset::PanelResult drawn = draw();
            for (const auto& [name, at] : drawn.items) {
                EXPECT_TRUE(at.x > 0 && at.x < 1 && at.y > 0 && at.y < 1) << name << " " << at.x << " " << at.y;
                last_row = std::max(last_row, at.y);
            }
            EXPECT_EQ(drawn.items.at("leave").y, last_row) << "other rows end above it";
        }
}

TEST_F(PanelRows, WhatNeedsASelectionDoesNothingWithoutOne) {
    for (const char* item : {"copy", "delete", "floor", "spin", "slower", "later"}) draw(item);
    EXPECT_FALSE(state.editor.modified());
    EXPECT_TRUE(state.editor.take_notices().empty());
    state.editor.select(node("ben"));
    draw("spin");
    EXPECT_TRUE(state.editor.modified());
}

TEST_F(PanelRows, AKeyboardRenamesWhoIsSelected) {
    draw("rename");
    EXPECT_EQ(state.dialogue, headset::PanelDialogue::kNone) << "nobody is selected";
    state.editor.select(node("ben"));
    draw("rename");
    ASSERT_EQ(state.dialogue, headset::PanelDialogue::kKeyboard);
    EXPECT_EQ(state.typed, "ben");
    for (int i = 0; i < 3; i++) draw("key back");
    for (const char* key : {"key e", "key v", "key a", "key space", "key 2"}) draw(key);
    EXPECT_EQ(state.typed, "Eva 2");
    const headset::PanelResult keys = draw();
    for (const auto& [name, at] : keys.items) EXPECT_TRUE(at.x > 0 && at.x < 1) << name;
    draw("key done");
    EXPECT_EQ(state.dialogue, headset::PanelDialogue::kNone);
    EXPECT_EQ(state.stage->performers[1].name, "Eva 2");
    draw("rename");
    draw("key back");
    draw("key cancel");
    EXPECT_EQ(state.stage->performers[1].name, "Eva 2");
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(PanelRows, TheStagePageAddsAndShowsPerformers) {
    state.editor.select(node("ben"));
    draw("hide");
    state.page = headset::PanelPage::kStage;
    draw();
    draw("show ben");
    EXPECT_EQ(state.editor.selected(), node("ben"));
    draw("add");
    draw("clip figure.nvv");
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.dialogue, headset::PanelDialogue::kNone);
    EXPECT_EQ(undo_all(), 3u);
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
