#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr float kGrip = 7, kCurveStep = 2, kRowGap = 2;  // at scale 1
constexpr unsigned kBar = 0xff6b4f2b, kBarSelected = 0xff9a6a2c, kOutsideBar = 0xff3a322a, kCurve = 0xffe9d2b4,
                   kCurveOutside = 0x80e9d2b4;

// The visible part of a bar, pixels of the framebuffer.
struct BarArea {
    float left, right, top, bottom;
};

BarArea area_of(const Context& context, const TimelineView& view, const edit::PerformerTrack& track, float top) {
    const double end_s =
        std::isfinite(track.bar.end_s) ? track.bar.end_s : std::max(context.view.clock.duration_s(), 0.0);
    const float min_width = std::min(context.ui(3 * kGrip), view.right() - view.left());
    const float left = std::clamp(view.x_at(track.bar.start_s), view.left(), view.right() - min_width);
    const float right = std::clamp(view.x_at(end_s), left + min_width, view.right());
    return {left, right, top + context.ui(2), top + view.row_height - context.ui(2)};
}

void edit_time_map(Context& context, uint32_t node, edit::TimeEdit edit) {
    context.editor.edit(
        [node, edit = std::move(edit)](edit::Document& d) { return edit::edit_time(d.file, node, edit); });
}

// The clip's frame over stage time: the first at the bottom, the last at the top.
void draw_curve(const Context& context, const TimelineView& view, const stage::Timeline& timeline, const BarArea& bar) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float inset = context.ui(3), height = bar.bottom - bar.top - 2 * inset;
    const double frames = std::max(1.0, timeline.frames - 1.0);
    const auto y_at = [&](float x) {
        return bar.bottom - inset - height * static_cast<float>(stage::frame_at(timeline, view.axis.s_at(x)) / frames);
    };
    const auto draw = [&](float from, float to, unsigned colour) {
        if (to <= from) return;
        for (float x = from; x < to; x += context.ui(kCurveStep)) list.PathLineTo({x, y_at(x)});
        list.PathLineTo({to, y_at(to)});
        list.PathStroke(colour, 0, context.ui(1.25f));
    };
    draw(view.left(), bar.left, kCurveOutside);
    draw(bar.left, bar.right, kCurve);
    draw(bar.right, view.right(), kCurveOutside);
}

void draw_bar(Context& context, TimelineState& state, const editor::Waveforms& waveforms,
              const edit::PerformerTrack& track, const BarArea& bar, bool highlighted) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const TimelineView& view = state.view;
    const float round = context.ui(3);
    const bool selected = context.editor.selected() == track.node;
    list.AddRectFilled({view.left(), bar.top}, {view.right(), bar.bottom}, kOutsideBar, round);
    list.AddRectFilled({bar.left, bar.top}, {bar.right, bar.bottom}, selected ? kBarSelected : kBar, round);
    draw_waveform(context, state, waveforms, track, bar.top, bar.bottom);
    draw_curve(context, view, track.timeline, bar);
    if (highlighted || selected) list.AddRect({bar.left, bar.top}, {bar.right, bar.bottom}, ui::kAccent, round);
}

void time_tooltip(const Context& context, const TimelineView& view, const edit::PerformerTrack& track) {
    const double at_s = view.axis.s_at(ImGui::GetIO().MousePos.x);
    const double frame = stage::frame_at(track.timeline, at_s);
    const std::string end = std::isfinite(track.bar.end_s) ? "to " + text_of_time(track.bar.end_s) : "without end";
    ImGui::SetTooltip(
        "%s", fmt::format("{}: from {} {}\nat {} image {:.0f} of {}{}", track.name, text_of_time(track.bar.start_s),
                          end, text_of_time(at_s), frame, track.timeline.frames,
                          context.editor.dragging() ? "" : "\nDrag it to move, its ends to trim, with Alt to stagger")
                  .c_str());
}

// Edits the time map so that the dragged part of the bar follows the pointer.
void follow(Context& context, const TimelineView& view, BarDrag& drag, const edit::PerformerTrack& track) {
    if (!is_dragged(context) || drag.cancelled) return;
    const double edge_s = drag.part != BarPart::kEnd         ? drag.before.start_s
                          : std::isfinite(drag.before.end_s) ? drag.before.end_s
                                                             : context.view.clock.duration_s();
    const double pointer_s = view.axis.s_at(ImGui::GetIO().MousePos.x);
    const double to_s = snapped_time(context, view, edge_s + pointer_s - drag.grabbed_s), by_s = to_s - edge_s;
    if (by_s == drag.moved_s) return;
    drag.moved_s = by_s;
    const uint32_t node = track.node;
    if (drag.part == BarPart::kBody && drag.stagger) {
        context.editor.drag([node, by_s, stage = context.frame.stage](edit::Document& d) {
            return edit::stagger_together(d.file, stage->clips, node, by_s);
        });
        return;
    }
    context.editor.drag([node, by_s, to_s, rate = track.rate, part = drag.part](edit::Document& d) {
        return edit::edit_time(d.file, node, [&](const stage::TimeMap& map) {
            if (part == BarPart::kStart) return edit::trimmed_start(map, rate, to_s);
            return part == BarPart::kEnd ? edit::trimmed_end(map, rate, to_s) : edit::moved(map, rate, by_s);
        });
    });
}

// Drags a part of the bar, which is the last item of ImGui. Returns whether the pointer is over it.
bool drag_part(Context& context, const TimelineView& view, BarDrag& drag, const edit::PerformerTrack& track,
               BarPart part) {
    if (ImGui::IsItemActivated())
        drag = {track.node, part,     ImGui::GetIO().KeyAlt, false, view.axis.s_at(ImGui::GetIO().MousePos.x),
                0,          track.bar};
    if (ImGui::IsItemActive() && context.frame.escape) {
        context.editor.cancel_drag();
        drag.cancelled = true;
    }
    if (ImGui::IsItemActive() || ImGui::IsItemDeactivated()) follow(context, view, drag, track);
    if (ImGui::IsItemDeactivated() && !is_dragged(context)) context.editor.select(track.node);
    const bool highlighted = ImGui::IsItemHovered() || ImGui::IsItemActive();
    if (highlighted) ImGui::SetMouseCursor(part == BarPart::kBody ? ImGuiMouseCursor_Hand : ImGuiMouseCursor_ResizeEW);
    if (highlighted) time_tooltip(context, view, track);
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) ImGui::OpenPopup("time");
    return highlighted;
}

bool track_item(Context& context, const edit::PerformerTrack& track, const char* name, const char* text,
                bool on = false) {
    return menu_item(context, fmt::format("timeline/{}/{}", track.name, name), text, nullptr, on);
}

void speed_field(Context& context, const edit::PerformerTrack& track) {
    constexpr auto kFlags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic;
    auto speed = static_cast<float>(edit::speed_of(track.map));
    ImGui::SetNextItemWidth(context.ui(90));
    if (ImGui::DragFloat("speed", &speed, 0.01f, 0.05f, 20, "%.2f×", kFlags))
        context.editor.drag([node = track.node, rate = track.rate, speed](edit::Document& d) {
            return edit::edit_time(d.file, node, [&](const stage::TimeMap& map) {
                return edit::sped(map, rate, speed / edit::speed_of(map));
            });
        });
    context.report.item(fmt::format("timeline/{}/speed", track.name));
}

void repeat_items(Context& context, const edit::PerformerTrack& track) {
    constexpr std::pair<const char*, const char*> kItems[] = {
        {"once", "Once"}, {"loop", "Again and again"}, {"ping-pong", "Back and forth"}};
    for (const edit::Repeat repeat : {edit::Repeat::kOnce, edit::Repeat::kLoop, edit::Repeat::kPingPong}) {
        const auto [name, text] = kItems[static_cast<size_t>(repeat)];
        if (track_item(context, track, name, text, edit::repeat_of(track.map) == repeat))
            edit_time_map(context, track.node,
                          [repeat](const stage::TimeMap& map) { return edit::repeated(map, repeat); });
    }
}

void items_at_time(Context& context, const edit::PerformerTrack& track) {
    const double now_s = context.view.clock.displayed_s();
    const edit::ClipRate rate = track.rate;
    const auto now = [&](edit::TimeEdit edit) { edit_time_map(context, track.node, std::move(edit)); };
    if (track_item(context, track, "start_here", "Begin here"))
        now([=, by_s = now_s - track.bar.start_s](const stage::TimeMap& map) { return edit::moved(map, rate, by_s); });
    if (track_item(context, track, "trim_start", "Cut off what is before"))
        now([=](const stage::TimeMap& map) { return edit::trimmed_start(map, rate, now_s); });
    if (track_item(context, track, "trim_end", "Cut off what is after"))
        now([=](const stage::TimeMap& map) { return edit::trimmed_end(map, rate, now_s); });
    if (track_item(context, track, "hold", "Hold this image for a second"))
        now([=](const stage::TimeMap& map) { return edit::paused_at(map, rate, now_s, 1); });
    if (track_item(context, track, "freeze", "Freeze this image"))
        now([=](const stage::TimeMap& map) { return edit::frozen_at(map, rate, now_s); });
}

void time_menu(Context& context, const edit::PerformerTrack& track) {
    if (!ImGui::BeginPopup("time")) return;
    ImGui::TextDisabled("%s: %s", track.name.c_str(),
                        track.map.empty() ? "as the clip is" : stage::text_of(track.map).c_str());
    ImGui::Separator();
    speed_field(context, track);
    if (track_item(context, track, "reverse", "Backwards", edit::is_reversed(track.map)))
        edit_time_map(context, track.node,
                      [rate = track.rate](const stage::TimeMap& map) { return edit::reversed(map, rate); });
    ImGui::Separator();
    repeat_items(context, track);
    ImGui::Separator();
    items_at_time(context, track);
    ImGui::Separator();
    if (track_item(context, track, "reset", "As the clip is"))
        edit_time_map(context, track.node, [](const stage::TimeMap&) { return stage::TimeMap(); });
    ImGui::EndPopup();
}

void name_cell(Context& context, const TimelineView& view, const edit::PerformerTrack& track) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = view.names_width - view.row_height - context.ui(6), inset = context.ui(6);
    ImGui::SetCursorScreenPos({view.left() - view.row_height - context.ui(4), at.y});
    if (small_button(context, view, fmt::format("timeline/{}/menu", track.name), ICON_MORE,
                     "Speed, direction, loops …"))
        ImGui::OpenPopup("time");
    ImGui::SetCursorScreenPos(at);
    // A Selectable extends by half the spacing.
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, context.ui(kRowGap)});
    if (ImGui::Selectable("##name", context.editor.selected() == track.node, 0, {width, view.row_height}))
        context.editor.select(track.node);
    ImGui::PopStyleVar();
    context.report.item(fmt::format("timeline/{}/name", track.name));
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) ImGui::OpenPopup("time");
    const ImVec4 clip(at.x, at.y, at.x + width, at.y + view.row_height);
    ImGui::GetWindowDrawList()->AddText(nullptr, 0,
                                        {at.x + inset, std::round(at.y + (view.row_height - ImGui::GetFontSize()) / 2)},
                                        ImGui::GetColorU32(ImGuiCol_Text), track.name.c_str(), nullptr, 0, &clip);
    if (ImGui::IsItemHovered() && ImGui::CalcTextSize(track.name.c_str()).x > width - inset)
        ImGui::SetTooltip("%s", track.name.c_str());
}

}  // namespace

void performer_row(Context& context, TimelineState& state, const editor::Waveforms& waveforms,
                   const edit::PerformerTrack& track) {
    const TimelineView& view = state.view;
    ImGui::PushID(static_cast<int>(track.node));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    name_cell(context, view, track);
    const BarArea bar = area_of(context, view, track, at.y);
    const float grip = context.ui(kGrip), height = bar.bottom - bar.top;
    bool highlighted = false;
    const auto part = [&](const char* name, BarPart which, float left, float width) {
        ImGui::SetCursorScreenPos({left, bar.top});
        ImGui::InvisibleButton(name, {std::max(width, 1.0f), height});
        const std::string row = "timeline/" + track.name;
        context.report.item(which == BarPart::kBody ? row : row + "/" + name);
        highlighted |= drag_part(context, view, state.bar_drag, track, which);
    };
    part("start", BarPart::kStart, bar.left, grip);
    part("end", BarPart::kEnd, bar.right - grip, grip);
    part("body", BarPart::kBody, bar.left + grip, bar.right - bar.left - 2 * grip);
    if (ImGui::IsRectVisible({view.left(), at.y}, {view.right(), at.y + view.row_height}))
        draw_bar(context, state, waveforms, track, bar, highlighted);
    time_menu(context, track);
    ImGui::SetCursorScreenPos({at.x, at.y + view.row_height + context.ui(kRowGap)});
    ImGui::PopID();
}

}  // namespace neuvv::viewer
