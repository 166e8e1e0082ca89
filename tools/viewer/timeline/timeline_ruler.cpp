#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/ui/theme.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr float kHeight = 27, kRangeHeight = 9, kRangeGrip = 9;  // at scale 1
constexpr float kLabelPixels = 54, kMarkPixels = 5;
constexpr unsigned kMarkColour = 0xff6a6661, kTextColour = 0xffb5b0aa, kOutside = 0x66000000, kTimeColour = 0xff4f6bff;

void draw_marks(const Context& context, const TimelineView& view, float top, float bottom) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const double fps = context.view.clock.fps();
    const TimeMarks marks = marks_for(view.axis.s_per_px, fps, context.ui(kLabelPixels), context.ui(kMarkPixels));
    const double step_s = marks.major_s / marks.parts;
    const auto first = static_cast<int64_t>(std::ceil(std::max(0.0, view.axis.begin_s) / step_s));
    const auto last = static_cast<int64_t>(std::floor(view.axis.end_s() / step_s));
    for (int64_t i = first; i <= last; ++i) {
        const float x = std::floor(view.x_at(static_cast<double>(i) * step_s)) + 0.5f;
        const bool major = i % marks.parts == 0;
        list.AddLine({x, bottom - context.ui(major ? 7 : 3)}, {x, bottom}, kMarkColour);
        if (!major) continue;
        const std::string label = label_of(marks, i / marks.parts, fps);
        list.AddText({x + context.ui(4), top - context.ui(1)}, kTextColour, label.c_str());
    }
}

// The range of the loop as a bar whose ends can be dragged. A double click on an end resets the range to the whole
// stage.
void range_bar(Context& context, const TimelineView& view, float top) {
    editor::StageClock& clock = context.view.clock;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float height = context.ui(kRangeHeight), grip = context.ui(kRangeGrip);
    const float low = std::clamp(view.x_at(clock.in_s()), view.left(), view.right());
    const float high = std::clamp(view.x_at(clock.out_s()), view.left(), view.right());
    const bool whole = clock.in_s() <= 0 && clock.out_s() >= clock.duration_s();
    const float centre = std::round(top + height / 2), half = std::round(context.ui(2));
    list.AddRectFilled({view.left(), centre - half}, {view.right(), centre + half}, ui::kGroove, half);
    const unsigned colour = clock.loops && !whole ? ui::kAccent : ui::kFaint;
    list.AddRectFilled({low, centre - half}, {high, centre + half}, colour, half);
    for (const bool end : {false, true}) {
        const float at = end ? high : low;
        if (std::abs(view.x_at(end ? clock.out_s() : clock.in_s()) - at) > 1) continue;  // it is outside the axis
        // Outside the range, so that both ends can be grabbed where it is short.
        ImGui::SetCursorScreenPos({end ? at : at - grip, top});
        ImGui::InvisibleButton(end ? "out" : "in", {grip, height});
        context.report.item(end ? "timeline/out" : "timeline/in");
        const bool highlighted = ImGui::IsItemHovered() || ImGui::IsItemActive();
        const float side = end ? grip : -grip;
        list.AddTriangleFilled({at, top}, {at + side, centre}, {at, top + height}, highlighted ? ui::kAccent : colour);
        if (highlighted) {
            ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
            ImGui::SetTooltip(
                "%s\nDrag: what is played again and again. Double click: all.",
                fmt::format("loop from {} to {}", text_of_time(clock.in_s()), text_of_time(clock.out_s())).c_str());
        }
        if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
            clock.set_range(0, clock.duration_s());
        } else if ((ImGui::IsItemActive() || ImGui::IsItemDeactivated()) && is_dragged(context)) {
            const double shortest_s = 1 / clock.fps();
            const float pointer = std::clamp(ImGui::GetIO().MousePos.x, view.left(), view.right());
            const double to_s = std::clamp(snapped_time(context, view, view.axis.s_at(pointer)), view.axis.begin_s,
                                           view.axis.end_s());  // an end outside the axis could not be dragged again
            if (end)
                clock.set_range(clock.in_s(), std::max(to_s, clock.in_s() + shortest_s));
            else
                clock.set_range(std::min(to_s, clock.out_s() - shortest_s), clock.out_s());
        }
    }
}

}  // namespace

void draw_range_and_time(Context& context, const TimelineView& view, float top, float bottom) {
    const editor::StageClock& clock = context.view.clock;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float low = std::clamp(view.x_at(clock.in_s()), view.left(), view.right());
    const float high = std::clamp(view.x_at(clock.out_s()), view.left(), view.right());
    if (low > view.left()) list.AddRectFilled({view.left(), top}, {low, bottom}, kOutside);
    if (high < view.right()) list.AddRectFilled({high, top}, {view.right(), bottom}, kOutside);
    const float x = std::floor(view.x_at(clock.time_s())) + 0.5f;
    if (x < view.left() || x > view.right()) return;
    list.AddLine({x, top}, {x, bottom}, kTimeColour, std::max(1.0f, std::round(context.ui(1.5f))));
}

void ruler_row(Context& context, const TimelineView& view) {
    editor::StageClock& clock = context.view.clock;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float range = context.ui(kRangeHeight), height = std::round(context.ui(kHeight)), bottom = at.y + height;
    ImGui::PushClipRect({view.left(), at.y}, {view.right(), bottom}, true);
    draw_marks(context, view, at.y + range, bottom);
    draw_range_and_time(context, view, at.y + range, bottom);
    const float x = view.x_at(clock.time_s()), side = context.ui(5);
    ImGui::GetWindowDrawList()->AddTriangleFilled({x - side, at.y + range}, {x + side, at.y + range},
                                                  {x, at.y + range + 1.4f * side}, kTimeColour);
    ImGui::PopClipRect();
    range_bar(context, view, at.y);
    ImGui::SetCursorScreenPos({view.left(), at.y + range});
    ImGui::InvisibleButton("ruler", {static_cast<float>(view.axis.width), height - range});
    context.report.item("timeline/ruler");
    if (ImGui::IsItemActive() || ImGui::IsItemDeactivated()) {
        clock.scrub(nearest_frame_time(view.axis.s_at(ImGui::GetIO().MousePos.x), clock.fps()));
        context.mark_motion();
    }
    ImGui::SetCursorScreenPos({at.x, bottom + context.ui(2)});
}

}  // namespace neuvv::viewer
