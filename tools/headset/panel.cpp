#include "tools/headset/panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "edit/operations.h"
#include "tools/viewer/signs.h"

namespace neuvv {

namespace {

float width_of(int columns, int of) {
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    return (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(of - 1)) / static_cast<float>(of) *
               static_cast<float>(columns) +
           gap * static_cast<float>(columns - 1);
}

bool button(const char* label, float width, bool on = false) {
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    const bool pressed = ImGui::Button(label, {width, ImGui::GetFrameHeight() * 1.25f});
    if (on) ImGui::PopStyleColor();
    return pressed;
}

void time_rows(OnStage& on) {
    StageClock& clock = on.clock;
    const float one = width_of(1, 6);
    if (button(SIGN_START "##start", one)) clock.scrub(clock.in_s());
    ImGui::SameLine();
    if (button(SIGN_STEP_BACK "##back", one)) clock.step(-1);
    ImGui::SameLine();
    if (button(clock.playing ? SIGN_PAUSE "##play" : SIGN_PLAY "##play", one, clock.playing)) clock.play_or_pause();
    ImGui::SameLine();
    if (button(SIGN_STEP "##step", one)) clock.step(1);
    ImGui::SameLine();
    if (button(SIGN_REVERSE "##reverse", one, clock.speed < 0)) clock.speed = -clock.speed;
    ImGui::SameLine();
    if (button(SIGN_LOOP "##loop", one, clock.loops)) clock.loops = !clock.loops;

    auto seconds = static_cast<float>(clock.time_s());
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##time", &seconds, 0, static_cast<float>(clock.duration_s()),
                           fmt::format("%.2f of {:.2f} s", clock.duration_s()).c_str()))
        clock.scrub(seconds);
    auto speed = static_cast<float>(std::abs(clock.speed));
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##speed", &speed, 0.1f, 4, "speed %.2f", ImGuiSliderFlags_Logarithmic))
        clock.speed = std::copysign(speed, clock.speed);
}

void tool_row(OnStage& on) {
    const float one = width_of(1, 3);
    const auto tool = [&](const char* label, HandTool which) {
        if (button(label, one, on.tool == which)) on.tool = which;
    };
    tool(SIGN_MOVE " Arrange", HandTool::kArrange);
    ImGui::SameLine();
    tool(SIGN_BRUSH " Paint", HandTool::kPaint);
    ImGui::SameLine();
    tool(SIGN_BOX " Region", HandTool::kRegion);
}

const PerformerSettings* settings_of(const OnStage& on) {
    const auto performer = on.selected_performer();
    return performer ? &on.stage->performers[*performer].settings : nullptr;
}

void set(OnStage& on, const PerformerEdit& edit) {
    const uint32_t node = *on.editor.selected();
    on.editor.edit([&](Document& document) { return set_performer(document.file, node, edit); });
}

void snap_to_floor(OnStage& on) {
    const auto performer = on.selected_performer();
    if (!performer) return;
    const uint32_t node = on.stage->performers[*performer].node;
    const auto [low, high] = box_of(*on.stage, *performer);
    const int32_t parent = on.stage->scene.nodes[node].parent;
    const glm::dmat4 world_from_parent =
        parent < 0 ? glm::dmat4(1) : on.instant.pose.world_from_node[static_cast<size_t>(parent)];
    Placement placement;
    placement.to =
        glm::inverse(world_from_parent) * on_floor(on.instant.pose.world_from_node[node], low, high, on.floor_m);
    on.editor.edit([&](Document& document) { return place_node(document.file, node, placement); });
}

void arrange_rows(OnStage& on, Interaction& interaction) {
    const PerformerSettings* performer = settings_of(on);
    const auto index = on.selected_performer();
    ImGui::TextUnformatted(index ? on.stage->performers[*index].name.c_str()
                                 : "Point at a performer and pull the trigger");
    ImGui::BeginDisabled(!performer);
    const float one = width_of(1, 4);
    if (button(SIGN_COPY " Copy", one)) duplicate_selected(on);
    ImGui::SameLine();
    if (button(SIGN_TRASH " Delete", one)) delete_selected(on);
    ImGui::SameLine();
    if (button(SIGN_MAGNET " Floor", one)) snap_to_floor(on);
    ImGui::SameLine();
    const double spin = performer ? performer->spin_deg_per_s : 0;
    if (button(SIGN_ROTATE " Spin", one, spin != 0) && performer) set(on, {.spin_deg_per_s = spin == 0 ? 30 : 0});
    ImGui::EndDisabled();
    ImGui::Checkbox("Upright", &interaction.holding.settings.upright);
    ImGui::SameLine();
    ImGui::Checkbox("Stand on the floor", &interaction.holding.settings.snaps_to_floor);
}

void brush_rows(OnStage& on) {
    HandBrush& brush = on.brush;
    ImGui::ColorPicker3("##colour", &brush.colour.x,
                        ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                            ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoAlpha);
    ImGui::SameLine();
    ImGui::BeginGroup();
    const float half = width_of(1, 2);
    if (button(SIGN_BRUSH " Colour", half, brush.does == HandBrush::Does::kPaint)) brush.does = HandBrush::Does::kPaint;
    ImGui::SameLine();
    if (button(SIGN_ERASER " Erase", half, brush.does == HandBrush::Does::kErase)) brush.does = HandBrush::Does::kErase;
    if (button("Ball", half, brush.tip == HandBrush::Tip::kBall)) brush.tip = HandBrush::Tip::kBall;
    ImGui::SameLine();
    if (button("Box", half, brush.tip == HandBrush::Tip::kBox)) brush.tip = HandBrush::Tip::kBox;
    auto centimetres = static_cast<float>(100 * brush.radius_m);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##radius", &centimetres, 1, 40, "radius %.0f cm", ImGuiSliderFlags_Logarithmic))
        brush.radius_m = centimetres / 100;
    auto opacity = static_cast<float>(100 * brush.opacity);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##opacity", &opacity, 5, 100, "opacity %.0f %%")) brush.opacity = opacity / 100;
    ImGui::Checkbox("Through the whole clip", &brush.whole_clip);
    ImGui::EndGroup();
}

void region_rows(OnStage& on, Interaction& interaction) {
    brush_rows(on);
    ImGui::BeginDisabled(!interaction.brush.region());
    const float half = width_of(1, 2);
    if (button(on.brush.does == HandBrush::Does::kErase ? SIGN_ERASER " Erase the box" : SIGN_BRUSH " Colour the box",
               half))
        interaction.brush.do_region(on);
    ImGui::SameLine();
    if (button("Forget the box", half)) interaction.brush.forget_region();
    ImGui::EndDisabled();
}

void set(OnStage& on, const StageEdit& edit) {
    on.editor.edit([&](Document& document) { return set_stage(document.file, edit); });
}

void light_row(OnStage& on) {
    bool shadows = on.stage->settings.shadows, falloff = on.stage->settings.falloff;
    if (ImGui::Checkbox("Shadows", &shadows)) set(on, StageEdit{.shadows = shadows});
    ImGui::SameLine();
    if (ImGui::Checkbox("Lights on performers", &falloff)) set(on, StageEdit{.falloff = falloff});
}

void comfort_rows(OnStage& on) {
    ImGui::Checkbox("Walk smoothly", &on.comfort.smooth_walk);
    ImGui::SameLine();
    ImGui::Checkbox("Turn smoothly", &on.comfort.smooth_turn);
    ImGui::SameLine();
    ImGui::Checkbox("Dark edges", &on.comfort.vignette);
    ImGui::Checkbox("Panel on the left wrist", &on.panel_on_wrist);
}

PanelAsks file_row(OnStage& on, Interaction& interaction, const PanelFacts& facts) {
    PanelAsks asks;
    const float one = width_of(1, 4);
    const auto put_down = [&] {
        interaction.holding.put_down(on);
        interaction.brush.end_stroke(on);
    };
    ImGui::BeginDisabled(!on.editor.history().next_undo());
    if (button(SIGN_UNDO " Undo", one)) {
        put_down();
        on.editor.undo();
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!on.editor.history().next_redo());
    if (button(SIGN_REDO " Redo", one)) on.editor.redo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!on.editor.modified() || facts.saving);
    asks.save = button(SIGN_SAVE " Save", one);
    ImGui::EndDisabled();
    ImGui::SameLine();
    asks.leave = button("Leave", one);
    return asks;
}

void notice_rows(const BrushHand& brush, const PanelFacts& facts) {
    if (!brush.waits_for().empty()) ImGui::TextDisabled("%s", brush.waits_for().c_str());
    if (facts.notices.empty()) {
        ImGui::TextDisabled("%s", fmt::format("{:.0f} pictures a second, {:.0f} % of the rays", facts.pictures_a_second,
                                              100 * facts.scale * facts.scale)
                                      .c_str());
        return;
    }
    const Notice& last = facts.notices.back();
    if (last.error) ImGui::PushStyleColor(ImGuiCol_Text, {1, 0.55f, 0.4f, 1});
    ImGui::TextWrapped("%s", last.text.c_str());
    if (last.error) ImGui::PopStyleColor();
}

}  // namespace

PanelAsks draw_panel(OnStage& on, Interaction& interaction, const PanelFacts& facts) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::SetNextWindowBgAlpha(1);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    time_rows(on);
    ImGui::Separator();
    tool_row(on);
    if (on.tool == HandTool::kArrange) arrange_rows(on, interaction);
    if (on.tool == HandTool::kPaint) brush_rows(on);
    if (on.tool == HandTool::kRegion) region_rows(on, interaction);
    if (on.tool == HandTool::kArrange) {
        ImGui::Separator();
        light_row(on);
        comfort_rows(on);
    }
    ImGui::Separator();
    const PanelAsks asks = file_row(on, interaction, facts);
    notice_rows(interaction.brush, facts);
    ImGui::End();
    return asks;
}

}  // namespace neuvv
