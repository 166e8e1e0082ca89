// The panel of hands at a stage, without a device: its widgets, and a ray that presses and drags them.
#pragma once

#include <imgui.h>

#include <cfloat>

#include "headset/hands_at_a_stage.h"
#include "tools/headset/coaching.h"
#include "tools/headset/panel.h"
#include "tools/headset/panel_surface.h"
#include "tools/ui/theme.h"

namespace neuvv::test {

class PanelAtAStage : public HandsAtAStage {
  protected:
    static constexpr float kWidth = headset::kPanelWidth, kHeight = headset::kPanelHeight;
    PanelAtAStage() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {kWidth, kHeight};
        ui::apply_theme(headset::kPanelScale);
        io.Fonts->Build();
        draw();
    }
    ~PanelAtAStage() override { ImGui::DestroyContext(); }

    // Runs a frame of hands and panel. `at` is where a ray meets the panel: 0..1 from the upper left.
    void draw(std::optional<glm::dvec2> at = {}, bool pressed = false) {
        frame();
        draw_under(at, pressed);
    }
    // The same, where the ray is that of the hand that points at the panel.
    void draw_by_hand() {
        frame();
        const headset::PanelPointer pointer = interaction.panel_pointer();
        draw_under(pointer.uv, pointer.pressed);
    }
    void draw_under(std::optional<glm::dvec2> at, bool pressed) {
        ImGuiIO& io = ImGui::GetIO();
        io.DeltaTime = 1.0f / 90;
        io.MousePos = at ? ImVec2{float(at->x) * kWidth, float(at->y) * kHeight} : ImVec2{-FLT_MAX, -FLT_MAX};
        io.MouseDown[0] = pressed;
        ImGui::NewFrame();
        headset::PanelStatus status;
        status.head = head;
        headset::PanelResult result = headset::draw_panel(state, interaction, coaching, status);
        items = std::move(result.items);
        cut_off = std::move(result.cut_off);
        if (!result.open.empty()) opened = result.open;
        ImGui::Render();
    }
    bool has(const std::string& item) const { return items.contains(item); }
    void press(const std::string& item) {
        ASSERT_TRUE(has(item)) << item;
        const glm::dvec2 at = items[item];
        draw(at);
        draw(at, true);
        draw(at);
        draw_settled();
    }
    // Draws the panel as often as its layout needs.
    void draw_settled() {
        for (int i = 0; i < 4; ++i) draw();
    }
    // Takes a slider in its middle and drags it sideways, by shares of the panel's width.
    void drag(const std::string& item, std::initializer_list<double> to) {
        ASSERT_TRUE(has(item)) << item;
        const glm::dvec2 from = items[item];
        draw(from);
        draw(from, true);
        for (const double by : to) draw(from + glm::dvec2(by, 0), true);
        draw();
        draw();
    }
    size_t steps() {  // of the history; undoes them all
        const size_t count = undo_all();
        draw();
        return count;
    }

    headset::Coaching coaching = headset::Coaching(jobs);
    std::map<std::string, glm::dvec2> items;  // of the panel that was drawn last
    std::vector<std::string> cut_off;         // labels that do not fit their buttons
    std::filesystem::path opened;             // what was chosen last to be opened
};

}  // namespace neuvv::test
