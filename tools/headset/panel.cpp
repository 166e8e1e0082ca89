#include "tools/headset/panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "edit/operations.h"
#include "edit/time_edit.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr double kLater_s = 0.5, kSpin_deg_per_s = 30;

// The panel while it is put up: what its rows need, and where its buttons are.
struct Rows {
    OnStage& on;
    Interaction& interaction;
    const PanelFacts& facts;
    PanelAsks asks;

    // The item that was put up last can be found by this name.
    void note(const char* name) {
        const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax(), size = ImGui::GetIO().DisplaySize;
        asks.items[name] = {0.5 * (low.x + high.x) / size.x, 0.5 * (low.y + high.y) / size.y};
    }
    bool button(const char* name, const char* label, float width, bool is_on = false) {
        ImGui::PushID(name);
        if (is_on) {
            ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
            ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        }
        const bool pressed = ImGui::Button(label, {width, ImGui::GetFrameHeight() * 1.2f});
        if (is_on) ImGui::PopStyleColor(2);
        ImGui::PopID();
        note(name);
        return pressed;
    }
    // A sign alone, whose words come up under the ray.
    bool sign(const char* name, const char* label, const char* words, float width, bool is_on = false) {
        const bool pressed = button(name, label, width, is_on);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", words);
        return pressed;
    }
    bool checkbox(const char* name, const char* label, bool* value) {
        const bool changed = ImGui::Checkbox(label, value);
        note(name);
        return changed;
    }
};

// Of `of` columns as wide as what is left.
float width_of(int of) {
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    return (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(of - 1)) / static_cast<float>(of);
}

void time_rows(Rows& rows) {
    editor::StageClock& clock = rows.on.clock;
    const float one = width_of(6);
    if (rows.sign("start", ICON_START, "To the start", one)) clock.scrub(clock.in_s());
    ImGui::SameLine();
    if (rows.sign("back", ICON_STEP_BACK, "An image back", one)) clock.step(-1);
    ImGui::SameLine();
    if (rows.sign("play", clock.playing ? ICON_PAUSE : ICON_PLAY, "Play, pause", one, clock.playing))
        clock.play_or_pause();
    ImGui::SameLine();
    if (rows.sign("step", ICON_STEP, "An image on", one)) clock.step(1);
    ImGui::SameLine();
    if (rows.sign("backwards", ICON_REVERSE, "The stage backwards", one, clock.speed < 0)) clock.speed = -clock.speed;
    ImGui::SameLine();
    if (rows.sign("loop", ICON_LOOP, "Again and again", one, clock.loops)) clock.loops = !clock.loops;

    auto seconds = static_cast<float>(clock.time_s());
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##time", &seconds, 0, static_cast<float>(clock.duration_s()),
                           fmt::format("%.2f of {:.2f} s", clock.duration_s()).c_str()))
        clock.scrub(seconds);
    rows.note("time");
    auto speed = static_cast<float>(std::abs(clock.speed));
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##speed", &speed, 0.1f, 4, "speed %.2f", ImGuiSliderFlags_Logarithmic))
        clock.speed = std::copysign(speed, clock.speed);
    rows.note("speed");
}

void tool_row(Rows& rows) {
    const float one = width_of(3);
    const auto tool = [&](const char* name, const char* label, HandTool which) {
        if (rows.button(name, label, one, rows.on.tool == which)) rows.on.tool = which;
    };
    tool("arrange", ICON_MOVE " Arrange", HandTool::kArrange);
    ImGui::SameLine();
    tool("paint", ICON_BRUSH " Paint", HandTool::kPaint);
    ImGui::SameLine();
    tool("region", ICON_BOX " Region", HandTool::kRegion);
}

const stage::StagePerformer* selected(const OnStage& on) {
    const auto performer = on.selected_performer();
    return performer ? &on.stage->performers[*performer] : nullptr;
}

void set(OnStage& on, const edit::PerformerEdit& edit) {
    const uint32_t node = *on.editor.selected();
    on.editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, node, edit); });
}

void snap_to_floor(OnStage& on) {
    const auto performer = on.selected_performer();
    if (!performer) return;
    const uint32_t node = on.stage->performers[*performer].node;
    const auto [low, high] = editor::box_of(on, *performer);
    stand_at(on, node, on_floor(on.evaluated.pose.world_from_node[node], low, high, on.floor_m));
}

// Each edit of a map may find that the map cannot have it: that is told, as an operation's failure is.
template <typename Edit>
void retime(OnStage& on, const stage::StagePerformer& performer, const Edit& edit) {
    const stage::StageClip& clip = on.stage->clips[performer.clip];
    on.editor.edit([&](edit::Document& document) {
        edit::PerformerEdit timed;
        timed.time = edit(performer.settings.time, edit::ClipRate{clip.frames, clip.fps});
        return edit::set_performer(document.file, performer.node, timed);
    });
}

void retime_row(Rows& rows, const stage::StagePerformer& performer) {
    OnStage& on = rows.on;
    const float one = width_of(5);
    if (rows.button("slower", "half speed", one))
        retime(on, performer,
               [](const stage::TimeMap& map, const edit::ClipRate& clip) { return edit::sped(map, clip, 0.5); });
    ImGui::SameLine();
    if (rows.button("faster", "double speed", one))
        retime(on, performer,
               [](const stage::TimeMap& map, const edit::ClipRate& clip) { return edit::sped(map, clip, 2); });
    ImGui::SameLine();
    if (rows.button("reverse", "backwards", one))
        retime(on, performer,
               [](const stage::TimeMap& map, const edit::ClipRate& clip) { return edit::reversed(map, clip); });
    ImGui::SameLine();
    if (rows.button("earlier", "0.5 s earlier", one))
        retime(on, performer,
               [](const stage::TimeMap& map, const edit::ClipRate& clip) { return edit::moved(map, clip, -kLater_s); });
    ImGui::SameLine();
    if (rows.button("later", "0.5 s later", one))
        retime(on, performer,
               [](const stage::TimeMap& map, const edit::ClipRate& clip) { return edit::moved(map, clip, kLater_s); });
}

// Of the performer's own clip, at this time.
double seconds_shown(const OnStage& on, const stage::StagePerformer& performer) {
    for (const stage::EvaluatedPerformer& at : on.evaluated.performers)
        if (&on.stage->performers[at.performer] == &performer) return at.frame / on.stage->clips[performer.clip].fps;
    return 0;
}

void arrange_rows(Rows& rows) {
    OnStage& on = rows.on;
    const stage::StagePerformer* performer = selected(on);
    if (!performer) {
        ImGui::TextWrapped("Point at a performer and pull the trigger to select it; the grip holds it.");
    } else {
        ImGui::Text("%s", performer->name.c_str());
        ImGui::SameLine();
        ImGui::TextDisabled("%s", fmt::format("shows {:.2f} s of its clip", seconds_shown(on, *performer)).c_str());
        const float one = width_of(4);
        if (rows.button("copy", ICON_COPY " Copy", one)) duplicate_selected(on);
        ImGui::SameLine();
        if (rows.button("delete", ICON_TRASH " Delete", one)) delete_selected(on);
        ImGui::SameLine();
        if (rows.button("floor", ICON_MAGNET " Floor", one)) snap_to_floor(on);
        ImGui::SameLine();
        const double spin = performer->settings.spin_deg_per_s;
        if (rows.button("spin", ICON_ROTATE " Spin", one, spin != 0))
            set(on, {.spin_deg_per_s = spin == 0 ? kSpin_deg_per_s : 0});
        retime_row(rows, *performer);
    }
    rows.checkbox("upright", "Upright", &rows.interaction.holding.settings.upright);
    ImGui::SameLine();
    rows.checkbox("snaps", "Snap to the floor", &rows.interaction.holding.settings.snaps_to_floor);
}

void tip_rows(Rows& rows, float half) {
    HandBrush& brush = rows.on.brush;
    if (rows.button("ball", "Ball", half, brush.tip == HandBrush::Tip::kBall)) brush.tip = HandBrush::Tip::kBall;
    ImGui::SameLine();
    if (rows.button("box", "Box", half, brush.tip == HandBrush::Tip::kBox)) brush.tip = HandBrush::Tip::kBox;
    auto centimetres = static_cast<float>(100 * brush.radius_m);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##radius", &centimetres, 100 * kLeastBrush_m, 100 * kLargestBrush_m, "radius %.0f cm",
                           ImGuiSliderFlags_Logarithmic))
        brush.radius_m = centimetres / 100;
}

void brush_rows(Rows& rows) {
    HandBrush& brush = rows.on.brush;
    ImGui::SetNextItemWidth(0.3f * ImGui::GetContentRegionAvail().x);  // so that all rows fit below it
    ImGui::ColorPicker3("##colour", &brush.colour.x,
                        ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                            ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoAlpha);
    ImGui::SameLine();
    ImGui::BeginGroup();
    const float half = width_of(2);
    if (rows.button("colour", ICON_BRUSH " Colour", half, brush.does == HandBrush::Does::kPaint))
        brush.does = HandBrush::Does::kPaint;
    ImGui::SameLine();
    if (rows.button("erase", ICON_ERASER " Erase", half, brush.does == HandBrush::Does::kErase))
        brush.does = HandBrush::Does::kErase;
    if (rows.on.tool == HandTool::kPaint) tip_rows(rows, half);
    auto opacity = static_cast<float>(100 * brush.opacity);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##opacity", &opacity, 100 * kLeastBrushOpacity, 100, "opacity %.0f %%"))
        brush.opacity = opacity / 100;
    rows.checkbox("whole clip", "Through the whole clip", &brush.whole_clip);
    ImGui::EndGroup();
}

void region_rows(Rows& rows) {
    brush_rows(rows);
    ImGui::BeginDisabled(!rows.interaction.brush.region());
    const float half = width_of(2);
    const bool erases = rows.on.brush.does == HandBrush::Does::kErase;
    if (rows.button("do region", erases ? ICON_ERASER " Erase the box" : ICON_BRUSH " Colour the box", half))
        rows.interaction.brush.do_region(rows.on);
    ImGui::SameLine();
    if (rows.button("forget region", "Forget the box", half)) rows.interaction.brush.forget_region();
    ImGui::EndDisabled();
}

void set(OnStage& on, const edit::StageEdit& edit) {
    on.editor.edit([&](edit::Document& document) { return edit::set_stage(document.file, edit); });
}

void light_row(Rows& rows) {
    bool shadows = rows.on.stage->settings.shadows, falloff = rows.on.stage->settings.falloff;
    if (rows.checkbox("shadows", "Shadows", &shadows)) set(rows.on, edit::StageEdit{.shadows = shadows});
    ImGui::SameLine();
    if (rows.checkbox("falloff", "Lights on performers", &falloff)) set(rows.on, edit::StageEdit{.falloff = falloff});
}

void comfort_rows(Rows& rows) {
    Comfort& comfort = rows.on.comfort;
    rows.checkbox("smooth walk", "Walk smoothly", &comfort.smooth_walk);
    ImGui::SameLine();
    rows.checkbox("smooth turn", "Turn smoothly", &comfort.smooth_turn);
    ImGui::SameLine();
    rows.checkbox("vignette", "Dark edges", &comfort.vignette);
    ImGui::SameLine();
    rows.checkbox("wrist", "Panel on the left wrist", &rows.on.panel_on_wrist);
}

void file_row(Rows& rows) {
    editor::Editor& editor = rows.on.editor;
    const float one = width_of(4);
    ImGui::BeginDisabled(!editor.history().next_undo());
    if (rows.button("undo", ICON_UNDO " Undo", one)) editor.undo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!editor.history().next_redo());
    if (rows.button("redo", ICON_REDO " Redo", one)) editor.redo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!editor.modified() || rows.facts.saving);
    rows.asks.save = rows.button("save", ICON_SAVE " Save", one);
    ImGui::EndDisabled();
    ImGui::SameLine();
    rows.asks.leave = rows.button("leave", "Leave", one);
}

void notice_rows(const Rows& rows) {
    const PanelFacts& facts = rows.facts;
    if (const std::string& waits = rows.interaction.brush.says(); !waits.empty())
        ImGui::TextDisabled("%s", waits.c_str());
    if (facts.notices.empty()) {
        ImGui::TextDisabled("%s", fmt::format("{:.0f} images a second, {:.0f} % of the rays", facts.images_per_second,
                                              100 * facts.scale * facts.scale)
                                      .c_str());
        return;
    }
    const editor::Notice& last = facts.notices.back();
    if (last.error) ImGui::PushStyleColor(ImGuiCol_Text, {1, 0.55f, 0.4f, 1});
    ImGui::TextWrapped("%s", last.text.c_str());
    if (last.error) ImGui::PopStyleColor();
}

}  // namespace

PanelAsks draw_panel(OnStage& on, Interaction& interaction, const PanelFacts& facts) {
    Rows rows{on, interaction, facts, {}};
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::SetNextWindowBgAlpha(1);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    time_rows(rows);
    ImGui::Separator();
    tool_row(rows);
    // Nothing is edited by the panel while a hand holds something or a stroke is laid: numbers of nodes would change
    // under them.
    const bool busy = interaction.holding.any() || interaction.brush.busy();
    if (on.tool == HandTool::kPaint) brush_rows(rows);
    ImGui::BeginDisabled(busy);
    if (on.tool == HandTool::kRegion) region_rows(rows);
    if (on.tool == HandTool::kArrange) {
        arrange_rows(rows);
        ImGui::Separator();
        light_row(rows);
    }
    ImGui::EndDisabled();
    if (on.tool == HandTool::kArrange) comfort_rows(rows);
    // Always in the same place, with two lines of notices below.
    const float line = ImGui::GetTextLineHeightWithSpacing(), row = 1.2f * ImGui::GetFrameHeightWithSpacing();
    ImGui::SetCursorPosY(std::max(ImGui::GetCursorPosY(), ImGui::GetWindowHeight() - row - 2.6f * line));
    ImGui::Separator();
    ImGui::BeginDisabled(busy);
    file_row(rows);
    ImGui::EndDisabled();
    notice_rows(rows);
    ImGui::End();
    return rows.asks;
}

}  // namespace neuvv::headset
