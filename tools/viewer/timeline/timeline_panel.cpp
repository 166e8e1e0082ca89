#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/viewer/panels/panels.h"
#include "tools/viewer/timeline/camera_path_view.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr float kNamesWidth = 150, kNamesShare = 0.45f, kRowHeight = 22, kMargin = 10;  // at scale 1
constexpr size_t kLineSteps = 24;
constexpr double kWheelPixels = 60;

void read_path(TimelineState& state, const Context& context) {
    if (state.path_of == context.editor.id()) return;
    state.path.reset();
    state.path_line.clear();
    if (context.editor.is_open()) state.path = edit::camera_path_of(context.editor.file());
    if (state.path) state.path_line = line_of(*state.path, kLineSteps);
    state.path_of = context.editor.id();
}

// Returns whether the tracks may have changed.
bool read_tracks(TimelineState& state, const Context& context) {
    if (!context.frame.stage || !context.editor.is_open()) {
        state.tracks.clear();
        return std::exchange(state.tracks_of, 0) != 0;
    }
    if (state.tracks_of == context.editor.id() && state.clips_of == context.frame.stage) return false;
    state.tracks = edit::performer_tracks(context.editor.file(), context.frame.stage->clips);
    state.tracks_of = context.editor.id();
    state.clips_of = context.frame.stage;
    return true;
}

void follow_sounds(TimelineState& state, editor::Waveforms& waveforms) {
    state.waveforms.clear();
    editor::Waveforms::Files files;
    for (const edit::PerformerTrack& track : state.tracks)
        if (!track.sound.empty()) files.insert(track.sound);
    waveforms.follow(std::move(files));
}

// The end of the stage, or that of a performer who plays longer.
double extent_of(const TimelineState& state, const editor::StageClock& clock) {
    double extent_s = clock.duration_s();
    for (const edit::PerformerTrack& track : state.tracks)
        if (std::isfinite(track.bar.end_s)) extent_s = std::max(extent_s, track.bar.end_s);
    return extent_s;
}

void lay_out(TimelineState& state, const Context& context) {
    TimelineView& view = state.view;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    view.names_left = at.x;
    view.names_width = std::round(std::min(context.ui(kNamesWidth), kNamesShare * width));
    view.row_height = std::round(context.ui(kRowHeight));
    view.axis.left = at.x + view.names_width;
    view.axis.width = std::max(1.0f, width - view.names_width - ImGui::GetStyle().ScrollbarSize);
    if (!context.editor.dragging())  // a change of the limits would move what is dragged away from the pointer
        view.limits = {extent_of(state, context.view.clock), context.view.clock.fps(), context.ui(kMargin)};
    view.axis = state.fits ? fitted(view.axis, view.limits) : scrolled(view.axis, 0, view.limits);
}

// The wheel and the middle button over the time axis, in any row of the panel.
void navigate(TimelineState& state, const Context& context, float top) {
    const ImGuiIO& io = ImGui::GetIO();
    TimelineView& view = state.view;
    const bool hovered =
        ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows | ImGuiHoveredFlags_AllowWhenBlockedByActiveItem) &&
        io.MousePos.y >= top;
    const bool over_time = hovered && io.MousePos.x >= view.left() && io.MousePos.x < view.right();
    const double before_s = view.axis.begin_s, before_scale = view.axis.s_per_px;
    if (over_time && io.MouseWheel != 0 && !io.KeyShift)
        view.axis = zoomed(view.axis, io.MousePos.x, io.MouseWheel, view.limits);
    const float sideways = io.MouseWheelH + (io.KeyShift ? io.MouseWheel : 0);
    if (over_time && sideways != 0)
        view.axis = scrolled(view.axis, context.ui(sideways * static_cast<float>(kWheelPixels)), view.limits);
    if (hovered && !over_time) state.scroll_y -= io.MouseWheel * view.row_height;
    if (state.panned) {
        view.axis = scrolled(view.axis, io.MouseDelta.x, view.limits);
        state.scroll_y -= io.MouseDelta.y;
    }
    // Set after this frame's motion was used, because the pointer moved before the button went down.
    if (over_time && ImGui::IsMouseClicked(ImGuiMouseButton_Middle)) state.panned = true;
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Middle)) state.panned = false;
    if (view.axis.begin_s != before_s || view.axis.s_per_px != before_scale) state.fits = false;
    if (over_time && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) state.fits = true;
}

// Scrolls to the row of a performer that was selected elsewhere.
void scroll_to_selected(TimelineState& state, const Context& context) {
    const auto selected = context.editor.selected();
    if (state.scrolled_selected == selected) return;
    const auto track = std::find_if(state.tracks.begin(), state.tracks.end(),
                                    [&](const edit::PerformerTrack& each) { return each.node == selected; });
    if (selected && track == state.tracks.end()) return;  // its track may not have been read yet
    state.scrolled_selected = selected;
    if (!selected) return;
    const float row = state.view.row_height + context.ui(2);
    scroll_to_row(static_cast<float>(track - state.tracks.begin()) * row, row);
}

void rows(TimelineState& state, Context& context, const editor::Waveforms& waveforms) {
    const ImVec2 at = ImGui::GetWindowPos();
    if (state.scroll_y != 0)
        ImGui::SetScrollY(std::clamp(ImGui::GetScrollY() + state.scroll_y, 0.0f, ImGui::GetScrollMaxY()));
    state.scroll_y = 0;
    scroll_to_selected(state, context);
    for (const edit::PerformerTrack& track : state.tracks) performer_row(context, state, waveforms, track);
    if (state.tracks.empty() && context.frame.stage) ImGui::TextDisabled("no performers yet");
    draw_range_and_time(context, state.view, at.y, at.y + ImGui::GetWindowHeight());
}

}  // namespace

double snapped_time(const Context& context, const TimelineView& view, double time_s) {
    const double clock_s = context.view.clock.time_s();
    if (std::abs(time_s - clock_s) < context.ui(5) * view.axis.s_per_px) return clock_s;
    return nearest_frame_time(time_s, context.view.clock.fps());
}

bool is_dragged(const Context& context) {
    const ImGuiIO& io = ImGui::GetIO();
    const ImVec2 from = io.MouseClickedPos[ImGuiMouseButton_Left];
    const float x = io.MousePos.x - from.x, y = io.MousePos.y - from.y, min = context.ui(3);
    return std::max(x * x + y * y, io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left]) >= min * min;
}

bool small_button(Context& context, const TimelineView& view, const std::string& name, const char* icon,
                  const char* tooltip, bool on, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    ImGui::PushID(name.c_str());
    if (!on) ImGui::PushStyleColor(ImGuiCol_Button, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 0});
    const bool pressed = ImGui::Button(icon, {view.row_height, view.row_height});
    ImGui::PopStyleVar();
    if (!on) ImGui::PopStyleColor();
    ImGui::PopID();
    context.report.item(name);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", tooltip);
    ImGui::EndDisabled();
    return pressed;
}

void timeline_panel(Context& context, const Area& area, TimelineState& state, editor::Waveforms& waveforms) {
    if (!begin_panel("timeline_panel", area)) return ImGui::End();
    if (read_tracks(state, context)) follow_sounds(state, waveforms);
    read_path(state, context);
    if (state.path && context.view.show_path && !context.view.along_path)
        draw_camera_path(context, *state.path, state.path_line);
    transport_row(context);
    lay_out(state, context);
    const float top = ImGui::GetCursorScreenPos().y;
    ruler_row(context, state.view);
    camera_row(context, state.view, state.key_drag, state.path);
    ImGui::BeginChild("tracks", {0, 0}, false, ImGuiWindowFlags_NoScrollWithMouse);
    rows(state, context, waveforms);
    ImGui::EndChild();
    navigate(state, context, top);
    ImGui::End();
}

}  // namespace neuvv::viewer
