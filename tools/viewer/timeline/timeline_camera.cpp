#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "edit/operations.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/timeline/camera_path_view.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr float kKeySize = 6;  // half a diamond, at scale 1
constexpr unsigned kLane = 0xff2f2b29, kKeyColour = 0xffd8d2cb, kPathColour = 0x60d8d2cb;

double frame_s(const Context& context) {
    return 1 / context.view.clock.fps();
}

void edit_path(Context& context, const stage::CameraPath& path) {
    context.editor.edit([path](edit::Document& d) { return edit::set_camera_path(d.file, path); });
}

void name_cell(Context& context, const TimelineView& view, bool has_path) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = view.row_height, gap = context.ui(1);
    ImGui::GetWindowDrawList()->AddText({at.x + context.ui(6), std::round(at.y + (side - ImGui::GetFontSize()) / 2)},
                                        ImGui::GetColorU32(ImGuiCol_Text), "Camera");
    ImGui::SetCursorScreenPos({view.left() - 3 * side - 2 * gap - context.ui(4), at.y});
    if (small_button(context, view, "timeline/add_key", ICON_PLUS,
                     "A key of the camera path: this view at this time (Enter; Shift+Enter removes the nearest)"))
        add_key_here(context);
    ImGui::SameLine(0, gap);
    if (small_button(context, view, "timeline/show_path", ICON_ROAD, "Show the camera path in the image",
                     context.view.show_path))
        context.view.show_path = !context.view.show_path;
    ImGui::SameLine(0, gap);
    if (small_button(context, view, "timeline/path", ICON_CAMERA,
                     has_path ? "Look along the camera path; looking around ends it" : "There is no camera path yet",
                     context.view.along_path, has_path))
        context.view.along_path = !context.view.along_path;
}

void key_items(Context& context, const stage::CameraPath& path, size_t key) {
    const auto item = [&](const char* name, const char* text) {
        return menu_item(context, fmt::format("timeline/key/{}/{}", key, name), text);
    };
    if (item("go", "Go there")) {
        context.view.clock.scrub(path.keys[key].time_s);
        context.go_to(eye_at(path, path.keys[key].time_s, context));
    }
    if (item("replace", "Take the present view"))
        context.editor.edit([now = key_of(context.view.eye, path.keys[key].time_s), step_s = frame_s(context)](
                                edit::Document& d) { return edit::add_path_key(d.file, now, step_s); });
    if (item("remove", "Remove"))
        context.editor.edit([key](edit::Document& d) { return edit::remove_path_key(d.file, key); });
    ImGui::Separator();
}

void path_items(Context& context, stage::CameraPath path) {
    constexpr std::pair<const char*, const char*> kInterpolations[] = {
        {"smooth", "Smooth"}, {"linear", "Straight from key to key"}, {"cut", "Cut from key to key"}};
    const auto item = [&](const char* name, const char* text, bool on) {
        return menu_item(context, fmt::format("timeline/path/{}", name), text, nullptr, on);
    };
    for (const stage::Interpolation interpolation :
         {stage::Interpolation::kSmooth, stage::Interpolation::kLinear, stage::Interpolation::kCut}) {
        const auto& [name, text] = kInterpolations[static_cast<size_t>(interpolation)];
        if (!item(name, text, path.interpolation == interpolation)) continue;
        path.interpolation = interpolation;
        edit_path(context, path);
    }
    ImGui::Separator();
    if (item("cyclic", "Round and round, back to the first key", path.cyclic))
        edit_path(context, with_cyclic(path, !path.cyclic));
    if (item("remove", "Remove the path", false))
        context.editor.edit([](edit::Document& d) { return edit::set_camera_path(d.file, std::nullopt); });
}

void move_key(Context& context, const TimelineView& view, KeyDrag& drag) {
    if (ImGui::IsItemActive() && context.frame.escape) {
        context.editor.cancel_drag();
        drag.cancelled = true;
        drag.to_s = drag.before.keys[drag.key].time_s;
    }
    if (!is_dragged(context) || drag.cancelled) return;
    const double from_s = drag.before.keys[drag.key].time_s;
    const double pointer_s = view.axis.s_at(ImGui::GetIO().MousePos.x);
    const double to_s = std::max(0.0, snapped_time(context, view, from_s + pointer_s - drag.grabbed_s));
    if (to_s == drag.to_s) return;
    drag.to_s = to_s;
    context.editor.drag([key = drag.key, to_s, step_s = frame_s(context)](edit::Document& d) {
        return edit::move_path_key(d.file, key, to_s, step_s);
    });
}

// Draws a key and drags it. Returns whether the pointer is over it.
bool key_button(Context& context, const TimelineView& view, std::optional<KeyDrag>& drag, const stage::CameraPath& path,
                size_t key, double time_s, float centre) {
    const float x = std::round(view.x_at(time_s)), half = context.ui(kKeySize);
    const bool dragged = drag && drag->key == key;
    if (!dragged && (x < view.left() - half || x > view.right() + half)) return false;
    ImGui::PushID(static_cast<int>(key));
    ImGui::SetCursorScreenPos({x - half, centre - half});
    ImGui::InvisibleButton("key", {2 * half, 2 * half});
    context.report.item(fmt::format("timeline/key/{}", key));
    if (ImGui::IsItemActivated()) drag = KeyDrag{key, false, view.axis.s_at(ImGui::GetIO().MousePos.x), time_s, path};
    if (drag && (ImGui::IsItemActive() || ImGui::IsItemDeactivated())) move_key(context, view, *drag);
    if (ImGui::IsItemDeactivated()) drag.reset();
    const bool highlighted = ImGui::IsItemHovered() || ImGui::IsItemActive();
    if (highlighted)
        ImGui::SetTooltip("camera at %s%s", text_of_time(time_s).c_str(),
                          ImGui::IsItemActive() ? "" : "\nDrag: earlier, later; right click: more");
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) ImGui::OpenPopup("key_menu");
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const bool now = std::abs(time_s - context.view.clock.time_s()) < frame_s(context) / 2;
    list.AddQuadFilled({x - half, centre}, {x, centre - half}, {x + half, centre}, {x, centre + half},
                       highlighted || now ? ui::kAccent : kKeyColour);
    if (ImGui::BeginPopup("key_menu")) {
        key_items(context, path, key);
        path_items(context, path);
        ImGui::EndPopup();
    }
    ImGui::PopID();
    return highlighted;
}

// Draws the path, from its first key to its end, and its keys. Returns whether the pointer is over a key.
bool draw_keys(Context& context, const TimelineView& view, std::optional<KeyDrag>& drag, const stage::CameraPath& now,
               float centre) {
    const bool released = !ImGui::IsMouseDown(ImGuiMouseButton_Left) && !ImGui::IsMouseReleased(ImGuiMouseButton_Left);
    if (released) drag.reset();  // released while the panel was not displayed
    const stage::CameraPath path = drag ? drag->before : now;
    const double end_s = now.cyclic ? now.duration_s : now.keys.back().time_s;
    const float low = std::clamp(view.x_at(now.keys.front().time_s), view.left(), view.right());
    const float high = std::clamp(view.x_at(end_s), view.left(), view.right());
    if (now.interpolation != stage::Interpolation::kCut)
        ImGui::GetWindowDrawList()->AddLine({low, centre}, {high, centre}, kPathColour, context.ui(2));
    ImGui::PushClipRect({view.left(), centre - view.row_height}, {view.right(), centre + view.row_height}, true);
    bool over_key = false;
    for (size_t i = 0; i < path.keys.size(); ++i)
        over_key |=
            key_button(context, view, drag, path, i, drag && drag->key == i ? drag->to_s : path.keys[i].time_s, centre);
    ImGui::PopClipRect();
    return over_key;
}

void draw_hint(const Context& context, const TimelineView& view, float top) {
    const ImVec4 lane(view.left(), top, view.right(), top + view.row_height);
    const ImVec2 at(std::max(view.x_at(0), view.left()) + context.ui(10),
                    std::round(top + (view.row_height - ImGui::GetFontSize()) / 2));
    ImGui::GetWindowDrawList()->AddText(nullptr, 0, at, ui::kFaint, "Enter: a key of a camera path, from this view",
                                        nullptr, 0, &lane);
}

}  // namespace

void camera_row(Context& context, const TimelineView& view, std::optional<KeyDrag>& drag,
                const std::optional<stage::CameraPath>& path) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float bottom = at.y + view.row_height, inset = context.ui(2);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    name_cell(context, view, path.has_value());
    list.AddRectFilled({view.left(), at.y + inset}, {view.right(), bottom - inset}, kLane, context.ui(3));
    bool over_key = false;
    if (path)
        over_key = draw_keys(context, view, drag, *path, at.y + view.row_height / 2);
    else
        draw_hint(context, view, at.y);
    ImGui::SetCursorScreenPos({view.left(), at.y});
    ImGui::InvisibleButton("camera_lane", {static_cast<float>(view.axis.width), view.row_height});
    context.report.item("timeline/camera");
    if (path && !over_key && ImGui::IsItemClicked(ImGuiMouseButton_Right)) ImGui::OpenPopup("path_menu");
    if (path && ImGui::BeginPopup("path_menu")) {
        path_items(context, *path);
        ImGui::EndPopup();
    }
    draw_range_and_time(context, view, at.y - inset, bottom + inset);
    ImGui::SetCursorScreenPos({at.x, bottom + context.ui(2)});
}

}  // namespace neuvv::viewer
