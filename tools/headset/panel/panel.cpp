#include "tools/headset/panel/panel.h"

#include <fmt/format.h>

#include <cmath>

#include "edit/operations.h"
#include "tools/headset/draw/images.h"
#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/arrange.h"
#include "tools/headset/state/coaching.h"
#include "tools/headset/state/performer_edits.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

// Heights of the panel's parts, in frame heights: they stay where they are, whatever is selected.
constexpr float kFileRow = 1.3f, kNoticeLines = 2.2f;
constexpr float kTimeShare = 0.62f;  // of the row of time and speed

void time_rows(Rows& rows) {
    editor::StageClock& clock = rows.state.clock;
    const float one = column_width(6);
    if (rows.icon_button("start", ICON_START, "To the start", one)) clock.scrub(clock.in_s());
    ImGui::SameLine();
    if (rows.icon_button("back", ICON_STEP_BACK, "An image back", one)) clock.step(-1);
    ImGui::SameLine();
    if (rows.icon_button("play", clock.playing ? ICON_PAUSE : ICON_PLAY, "Play, pause", one, clock.playing))
        clock.play_or_pause();
    ImGui::SameLine();
    if (rows.icon_button("step", ICON_STEP, "An image on", one)) clock.step(1);
    ImGui::SameLine();
    if (rows.icon_button("backwards", ICON_REVERSE, "The stage backwards", one, clock.speed < 0))
        clock.speed = -clock.speed;
    ImGui::SameLine();
    if (rows.icon_button("loop", ICON_LOOP, "Again and again", one, clock.loops)) clock.loops = !clock.loops;

    auto seconds = static_cast<float>(clock.time_s());
    ImGui::SetNextItemWidth(kTimeShare * ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderFloat("##time", &seconds, 0, static_cast<float>(clock.duration_s()),
                           fmt::format("%.2f of {:.2f} s", clock.duration_s()).c_str()))
        clock.scrub(seconds);
    rows.record_item("time");
    ImGui::SameLine();
    ImGui::BeginDisabled(rows.coaching.is_running());  // which has a speed of its own
    auto speed = static_cast<float>(std::abs(clock.speed));
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##speed", &speed, 0.1f, 4, "speed %.2f", ImGuiSliderFlags_Logarithmic))
        clock.speed = std::copysign(speed, clock.speed);
    ImGui::EndDisabled();
    rows.record_item("speed");
}

void tool_row(Rows& rows) {
    constexpr const char* kNames[] = {"arrange", "paint", "region", "lights", "coach"};
    const std::vector<const char*> labels = {"Arrange", "Paint", "Region", "Lights", "Coach"};
    const std::vector<float> widths = fitted_widths(labels);
    for (size_t i = 0; i < labels.size(); ++i) {
        const auto which = static_cast<HandTool>(i);
        if (i > 0) ImGui::SameLine();
        if (!rows.button(kNames[i], labels[i], widths[i], rows.state.tool == which)) continue;
        rows.state.tool = which;
        rows.state.dialogue = PanelDialogue::kNone;
    }
}

void page_row(Rows& rows) {
    constexpr const char* kNames[] = {"performer page", "time page", "copies page", "stage page", "user page"};
    const std::vector<const char*> labels = {"Performer", "Time", "Copies", "Stage", "You"};
    const std::vector<float> widths = fitted_widths(labels);
    for (size_t i = 0; i < labels.size(); ++i) {
        const auto which = static_cast<PanelPage>(i);
        if (i > 0) ImGui::SameLine();
        if (rows.button(kNames[i], labels[i], widths[i], rows.state.page == which)) rows.state.page = which;
    }
}

void name_row(Rows& rows) {
    HeadsetState& state = rows.state;
    const float one = column_width(3);
    if (rows.button("life size", ICON_SCALE " Life size", one)) give_life_size(state);
    ImGui::SameLine();
    if (rows.button("hide", ICON_EYE_OFF " Hide", one)) hide_selected(state);
    ImGui::SameLine();
    if (rows.button("rename", "Rename", one)) {
        state.types_address = false;
        state.typed_for = *state.editor.selected();
        state.typed = edit::name_of(state.editor.file(), state.typed_for);
        state.dialogue = PanelDialogue::kKeyboard;
    }
    if (rows.button("bring here", ICON_MOVE " Bring here", one)) bring_here(state, rows.status.head);
}

void grab_rows(Rows& rows) {
    PerformerGrabSettings& grab = rows.interaction.grab.settings;
    const float half = ImGui::GetCursorPosX() + column_width(2) + ImGui::GetStyle().ItemSpacing.x;
    rows.checkbox("upright", "Upright", &grab.upright);
    ImGui::SameLine(half);
    rows.checkbox("snaps", "Snap to the floor", &grab.snaps_to_floor);
    rows.checkbox("steps heading", "Turn by 15°", &grab.steps_heading);
    ImGui::SameLine(half);
    rows.checkbox("steps place", "Move by 0.25 m", &grab.steps_place);
}

// The rows are the same with and without a selected performer, so that none moves under a hand that selects one.
void performer_rows(Rows& rows) {
    HeadsetState& state = rows.state;
    const stage::StagePerformer* performer = selected_performer(state);
    performer_title(state);
    ImGui::BeginDisabled(!performer);
    const float one = column_width(3);
    if (rows.button("copy", ICON_COPY " Copy", one)) duplicate_selected(state);
    ImGui::SameLine();
    if (rows.button("delete", ICON_TRASH " Delete", one)) delete_selected(state);
    ImGui::SameLine();
    if (rows.button("floor", ICON_MAGNET " Floor", one)) put_selected_on_floor(state);
    name_row(rows);
    ImGui::EndDisabled();
    ImGui::Separator();
    grab_rows(rows);
}

// A press on the image's button takes the next one of the stage's folder.
void image_button(Rows& rows, float width) {
    HeadsetState& state = rows.state;
    const std::string label = ICON_STAMP " " + (state.image.empty() ? "Image" : state.image.stem().string());
    const bool is_on = state.brush.mode == HandBrush::Mode::kImage;
    if (!rows.button("image", label.c_str(), width, is_on)) return;
    if (is_on || state.image.empty())
        state.image = next_image(stage::absolute_path(state.editor.file().path).parent_path(), state.image);
    if (state.image.empty()) return state.editor.notify("there is no PNG file beside the stage", true);
    state.brush.mode = HandBrush::Mode::kImage;
}

void tip_rows(Rows& rows) {
    HandBrush& brush = rows.state.brush;
    const float one = 0.9f * column_width(4);  // what is left is the image's, which has the name of a file
    const bool has_tip = brush.mode != HandBrush::Mode::kImage;
    const auto tip = [&](const char* name, const char* label, HandBrush::Tip which) {
        if (rows.button(name, label, one, has_tip && brush.tip == which)) {
            brush.tip = which;
            if (!has_tip) brush.mode = HandBrush::Mode::kPaint;
        }
        ImGui::SameLine();
    };
    tip("ball", "Ball", HandBrush::Tip::kBall);
    tip("box", "Box", HandBrush::Tip::kBox);
    image_button(rows, column_width(1));
    auto centimetres = static_cast<float>(100 * brush.radius_m);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##radius", &centimetres, 100 * kMinBrush_m, 100 * kMaxBrush_m, "radius %.0f cm",
                           ImGuiSliderFlags_Logarithmic))
        brush.radius_m = centimetres / 100;
}

void brush_rows(Rows& rows) {
    HandBrush& brush = rows.state.brush;
    ImGui::SetNextItemWidth(0.3f * ImGui::GetContentRegionAvail().x);  // leaves room for the rows below
    ImGui::ColorPicker3("##colour", &brush.colour.x,
                        ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                            ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoAlpha);
    ImGui::SameLine();
    ImGui::BeginGroup();
    const float half = column_width(2);
    if (rows.button("colour", ICON_BRUSH " Colour", half, brush.mode == HandBrush::Mode::kPaint))
        brush.mode = HandBrush::Mode::kPaint;
    ImGui::SameLine();
    if (rows.button("erase", ICON_ERASER " Erase", half, brush.mode == HandBrush::Mode::kErase))
        brush.mode = HandBrush::Mode::kErase;
    if (rows.state.tool == HandTool::kPaint) tip_rows(rows);
    auto opacity = static_cast<float>(100 * brush.opacity);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##opacity", &opacity, 100 * kMinBrushOpacity, 100, "opacity %.0f %%"))
        brush.opacity = opacity / 100;
    if (rows.button("pick colour", ICON_TINT " Pick", half, rows.state.picks_colour))
        rows.state.picks_colour = !rows.state.picks_colour;
    ImGui::SameLine();
    rows.checkbox("whole clip", "Whole clip", &brush.whole_clip);
    if (rows.state.tool == HandTool::kPaint) rows.checkbox("by ray", "Where the ray meets", &brush.by_ray);
    ImGui::EndGroup();
}

void region_rows(Rows& rows) {
    brush_rows(rows);
    ImGui::BeginDisabled(!rows.interaction.painter.region());
    const float half = column_width(2);
    const bool erases = rows.state.brush.mode == HandBrush::Mode::kErase;
    if (rows.button("do region", erases ? ICON_ERASER " Erase the box" : ICON_BRUSH " Colour the box", half))
        rows.interaction.painter.apply_region(rows.state);
    ImGui::SameLine();
    if (rows.button("forget region", "Forget the box", half)) rows.interaction.painter.clear_region();
    ImGui::EndDisabled();
}

void user_rows(Rows& rows) {
    HeadsetState& state = rows.state;
    Comfort& comfort = state.comfort;
    const float half = column_width(2), second = ImGui::GetCursorPosX() + half + ImGui::GetStyle().ItemSpacing.x;
    rows.result.to_start = rows.button("to start", "Back to the start", half);
    ImGui::SameLine();
    bool is_seated = comfort.raised_m > 0;
    if (rows.toggle("seated", "Seated", half, is_seated))
        comfort.raised_m = is_seated ? raised_to_stand(rows.status.head) : 0;
    rows.slider("height", "raised by %.2f m", comfort.raised_m, kLowest_m, kHighest_m);
    rows.slider("volume", "volume %.0f %%", state.volume_percent, 0, kMostVolume_percent);
    rows.checkbox("smooth walk", "Walk smoothly", &comfort.smooth_walk);
    ImGui::SameLine(second);
    rows.checkbox("smooth turn", "Turn smoothly", &comfort.smooth_turn);
    rows.checkbox("vignette", "Dark edges", &comfort.vignette);
    ImGui::SameLine(second);
    rows.checkbox("hints", "Button hints", &state.hints);
    rows.checkbox("wrist", "Panel on wrist", &state.panel_on_wrist);
    ImGui::SameLine(second);
    rows.checkbox("left-handed", "Left-handed", &state.left_handed);
    bool room = state.shows_room;
    if (rows.checkbox("room", "Your own room", &room)) {
        state.wants_room = room;
        state.refused_room = false;
    }
    ImGui::SameLine(second);
    rows.checkbox("frame times", "Frame times", &state.shows_frame_times);
}

void file_row(Rows& rows) {
    editor::Editor& editor = rows.state.editor;
    const float one = column_width(4);
    ImGui::BeginDisabled(!editor.history().next_undo());
    if (rows.button("undo", ICON_UNDO " Undo", one)) editor.undo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!editor.history().next_redo());
    if (rows.button("redo", ICON_REDO " Redo", one)) editor.redo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!editor.modified() || rows.status.saving);
    rows.result.save = rows.button("save", ICON_SAVE " Save", one);
    ImGui::EndDisabled();
    ImGui::SameLine();
    rows.result.leave = rows.button("leave", "Leave", one);
}

// A line for what is being painted or read; and one for who is pointed at and one for the images, or up to two for what
// happened last.
void notice_rows(const Rows& rows) {
    const PanelStatus& status = rows.status;
    if (const std::string& waits = rows.interaction.painter.status(); !waits.empty())
        ImGui::TextDisabled("%s", waits.c_str());
    else if (rows.state.new_performer && !rows.state.new_performer->is_read)
        ImGui::TextDisabled(ICON_LOOP " reading %s", rows.state.new_performer->clip.filename().string().c_str());
    if (status.notices.empty()) {
        if (const auto performer = pointed_performer(rows.interaction.hands))
            ImGui::Text(ICON_PERSON " %s", rows.state.stage->performers[*performer].name.c_str());
        ImGui::TextDisabled("%s", fmt::format("{:.0f} images a second, {:.0f} % of the rays", status.images_per_second,
                                              100 * status.scale * status.scale)
                                      .c_str());
        return;
    }
    const editor::Notice& last = status.notices.back();
    if (last.error) ImGui::PushStyleColor(ImGuiCol_Text, {1, 0.55f, 0.4f, 1});
    ImGui::TextWrapped("%s", last.text.c_str());
    if (last.error) ImGui::PopStyleColor();
}

void arrange_rows(Rows& rows) {
    switch (rows.state.page) {
        case PanelPage::kPerformer:
            return performer_rows(rows);
        case PanelPage::kTime:
            return performer_time_rows(rows);
        case PanelPage::kCopies:
            return copies_rows(rows);
        case PanelPage::kStage:
            return stage_rows(rows);
        case PanelPage::kUser:
            return user_rows(rows);
    }
}

// The rows of the tool. Where they do not fit, they scroll.
void tool_rows(Rows& rows, bool busy) {
    if (rows.state.dialogue != PanelDialogue::kNone) {
        ImGui::BeginDisabled(busy);
        if (rows.state.dialogue == PanelDialogue::kClips) clip_rows(rows, rows.status.head);
        if (rows.state.dialogue == PanelDialogue::kFiles) file_rows(rows);
        if (rows.state.dialogue == PanelDialogue::kKeyboard) keyboard_rows(rows);
        return ImGui::EndDisabled();
    }
    if (rows.state.tool == HandTool::kPaint) return brush_rows(rows);
    if (rows.state.tool == HandTool::kCoach) return coaching_rows(rows);
    if (rows.state.tool == HandTool::kArrange) page_row(rows);
    ImGui::BeginDisabled(busy && !(rows.state.tool == HandTool::kArrange && rows.state.page == PanelPage::kUser));
    if (rows.state.tool == HandTool::kRegion) region_rows(rows);
    if (rows.state.tool == HandTool::kLights) lights_rows(rows);
    if (rows.state.tool == HandTool::kArrange) arrange_rows(rows);
    ImGui::EndDisabled();
}

}  // namespace

PanelResult draw_panel(HeadsetState& state, Interaction& interaction, Coaching& coaching, const PanelStatus& status) {
    Rows rows{state, interaction, coaching, status, {}};
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::SetNextWindowBgAlpha(1);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    if (state.dialogue == PanelDialogue::kKeyboard && !state.types_address &&
        state.editor.selected() != state.typed_for)
        state.dialogue = PanelDialogue::kNone;  // who was to be renamed is no longer selected
    time_rows(rows);
    ImGui::Separator();
    tool_row(rows);
    // The panel edits nothing while a hand grabs a performer or a stroke is unfinished: the numbers of nodes must not
    // change under them.
    const bool busy = interaction.is_holding() || interaction.painter.is_busy();
    const float below =
        kFileRow * ImGui::GetFrameHeightWithSpacing() + kNoticeLines * ImGui::GetTextLineHeightWithSpacing();
    if (ImGui::BeginChild("tool", {0, -below})) tool_rows(rows, busy);
    ImGui::EndChild();
    ImGui::Separator();
    ImGui::BeginDisabled(busy);
    file_row(rows);
    ImGui::EndDisabled();
    notice_rows(rows);
    ImGui::End();
    if (!rows.slider_held) state.release_slider();  // the hand let go, or the slider is no longer shown
    return rows.result;
}

}  // namespace neuvv::headset
