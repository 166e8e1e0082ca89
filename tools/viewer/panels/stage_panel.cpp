#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/stage_tree.h"

namespace neuvv::viewer {

namespace {

const char* icon_of(NodeKind kind) {
    switch (kind) {
        case NodeKind::kPerformer:
            return ICON_PERSON;
        case NodeKind::kLight:
            return ICON_LIGHT;
        case NodeKind::kCamera:
            return ICON_CAMERA;
        case NodeKind::kMesh:
            return ICON_SET;
        case NodeKind::kGroup:
            return ICON_FOLDER;
    }
    return "";
}

ImU32 text_colour(bool dim) {
    return ImGui::GetColorU32(dim ? ImGuiCol_TextDisabled : ImGuiCol_Text);
}

void light_menu(Context& context) {
    if (menu_item(context, "stage/add/spot", ICON_LIGHT "  Spotlight"))
        add_light_in_view(context, stage::GltfLightKind::kSpot);
    if (menu_item(context, "stage/add/point", ICON_BULLET "  Lamp"))
        add_light_in_view(context, stage::GltfLightKind::kPoint);
    if (menu_item(context, "stage/add/sun", ICON_SUN "  Sun"))
        add_light_in_view(context, stage::GltfLightKind::kDirectional);
}

void buttons(Context& context, StageTree& tree) {
    const auto node = context.editor.selected();
    const bool open = context.editor.is_open();
    if (icon_button(context, "stage/add_light", ICON_LIGHT, "Add a light", false, open)) ImGui::OpenPopup("lights");
    ImGui::SameLine();
    if (icon_button(context, "stage/add_camera", ICON_CAMERA, "Add a camera that sees what you see now", false, open))
        add_camera_in_view(context);
    if (ImGui::BeginPopup("lights")) {
        light_menu(context);
        ImGui::EndPopup();
    }
    ImGui::SameLine();
    if (icon_button(context, "stage/duplicate", ICON_COPY, "Duplicate in a row, a ring or a fan (one more: Ctrl+D)",
                    false, node.has_value()))
        ask_duplicate(context, tree.copies, *node);
    ImGui::SameLine();
    if (icon_button(context, "stage/delete", ICON_TRASH, "Delete (Del)", false, node.has_value()))
        delete_node(context, tree, *node);
}

void menu_of(Context& context, StageTree& tree, const StageRow& row) {
    const auto item = [&](const char* title, const char* keys) {
        return menu_item(context, std::string("stage/menu/") + title, title, keys);
    };
    if (item("Rename", "F2")) begin_renaming(tree, row.node);
    if (item("Duplicate", "Ctrl+D")) duplicate_once(context, row.node);
    if (item("Duplicate…", "")) ask_duplicate(context, tree.copies, row.node);
    if (item(row.visible ? "Hide" : "Show", ""))
        context.editor.edit([&](edit::Document& d) { return edit::show_node(d.file, row.node, !row.visible); });
    if (item(row.locked ? "Unlock" : "Lock", ""))
        context.editor.edit([&](edit::Document& d) { return edit::lock_node(d.file, row.node, !row.locked); });
    ImGui::Separator();
    if (item("Delete", "Del")) delete_node(context, tree, row.node);
}

// A button without a frame at the end of a row. Its icon is bright where it is `strong` or under the pointer, else
// faint, and then drawn only where it is `visible`. Returns whether it was pressed.
bool row_icon(Context& context, const char* id, const std::string& report, const char* icon, bool strong, bool visible,
              const char* tooltip) {
    const float side = ImGui::GetFrameHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool pressed = ImGui::InvisibleButton(id, {side, side});
    context.report.item(report);
    const bool hovered = ImGui::IsItemHovered();
    if (hovered) ImGui::SetTooltip("%s", tooltip);
    if (visible || hovered || strong) {
        const ImVec2 size = ImGui::CalcTextSize(icon);
        ImGui::GetWindowDrawList()->AddText(
            {std::round(at.x + 0.5f * (side - size.x)), std::round(at.y + 0.5f * (side - size.y))},
            text_colour(!strong && !hovered), icon);
    }
    return pressed;
}

// Draws text, cut with an ellipsis where it is too long. Returns whether it was cut.
bool cut_text(ImVec2 at, float width, ImU32 colour, const std::string& text) {
    const float whole = ImGui::CalcTextSize(text.c_str()).x;
    if (whole <= width) {
        ImGui::GetWindowDrawList()->AddText(at, colour, text.c_str());
        return false;
    }
    const float room = width - ImGui::CalcTextSize("…").x;
    const char* end = text.c_str();
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), std::max(room, 0.0f), 0, text.c_str(), nullptr, &end);
    ImGui::GetWindowDrawList()->AddText(at, colour, (std::string(text.c_str(), end) + "…").c_str());
    return true;
}

void name_field(Context& context, StageTree& tree, const StageRow& row, float width) {
    ImGui::SetNextItemWidth(width);
    const bool begins = std::exchange(tree.begin_typing, false);
    if (begins) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##name", &tree.typed,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    context.report.item("stage/" + row.title + "/name");
    if (!entered && !ImGui::IsItemDeactivated()) return;
    const std::string typed = tree.typed;
    tree.renaming.reset();
    if (typed != row.title && !typed.empty())
        context.editor.edit([&](edit::Document& d) { return edit::rename_node(d.file, row.node, typed); });
}

// The layout of a row, in pixels of the framebuffer.
struct RowArea {
    ImVec2 at;
    float right = 0, side = 0, icon_x = 0, name_x = 0, text_y = 0;
    float icons = 2;  // behind the name
    float name_width() const { return std::max(1.0f, right - icons * side - name_x); }
};

RowArea area_of_row(const StageRow& row) {
    constexpr uint32_t kDeepest = 12;  // a deeper indent would leave no room for names
    RowArea area;
    area.at = ImGui::GetCursorScreenPos();
    area.right = area.at.x + ImGui::GetContentRegionAvail().x;
    area.side = ImGui::GetFrameHeight();
    area.icon_x = area.at.x + (static_cast<float>(std::min(row.depth, kDeepest)) + 1) * std::round(0.7f * area.side);
    area.name_x = area.icon_x + std::round(area.side);
    area.text_y = area.at.y + ImGui::GetStyle().FramePadding.y;
    if (row.has_sound) ++area.icons;
    return area;
}

// Draws the caret, which opens and closes the list of descendants.
void draw_caret(Context& context, StageTree& tree, const StageRow& row, const RowArea& area) {
    if (row.descendants == 0) return;
    std::set<std::string>& closed = tree.closed;
    const bool is_closed = closed.contains(row.title);
    const float width = std::round(0.7f * area.side);
    ImGui::SetCursorScreenPos({area.icon_x - width, area.at.y});
    if (ImGui::InvisibleButton("open", {width, area.side})) {
        if (is_closed)
            closed.erase(row.title);
        else
            closed.insert(row.title);
    }
    context.report.item("stage/" + row.title + "/open");
    ImGui::GetWindowDrawList()->AddText({area.icon_x - width + 0.2f * area.side, area.text_y}, text_colour(true),
                                        is_closed ? ICON_CARET_RIGHT : ICON_CARET_DOWN);
}

void draw_name(Context& context, StageTree& tree, const StageRow& row, const RowArea& area, bool dim) {
    ImGui::SetCursorScreenPos({area.icon_x, area.at.y});
    ImGui::InvisibleButton("row", {area.name_x - area.icon_x + area.name_width(), area.side},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    context.report.item("stage/" + row.title);
    const bool hovered = ImGui::IsItemHovered();
    const bool cut = cut_text({area.name_x, area.text_y}, area.name_width() - ImGui::GetStyle().ItemSpacing.x,
                              text_colour(dim), row.title);
    if (cut && hovered) ImGui::SetTooltip("%s", row.title.c_str());
    if (hovered && (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1))) {
        tree.scrolled_selected = row.node;
        context.editor.select(row.node);
    }
    if (hovered && ImGui::IsMouseDoubleClicked(0)) begin_renaming(tree, row.node);
    const ImVec2 spacing = ImGui::GetStyle().ItemSpacing;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {spacing.x, 0.8f * spacing.x});  // of the menu, not of the tree
    if (ImGui::BeginPopupContextItem("menu")) {
        menu_of(context, tree, row);
        ImGui::EndPopup();
    }
    ImGui::PopStyleVar();
}

void draw_row_icons(Context& context, const StageRow& row, const RowArea& area, bool under) {
    const std::string report = "stage/" + row.title;
    if (row.has_sound) {
        const bool heard = context.view.hears(row.title);
        ImGui::SetCursorScreenPos({area.right - 3 * area.side, area.at.y});
        if (row_icon(context, "sound", report + "/sound", heard ? ICON_SOUND : ICON_SOUND_OFF, !heard, true,
                     heard ? "Mute. Shift: hear it alone" : "Not heard here. Shift: hear it alone"))
            context.view.toggle_sound(row.title, ImGui::GetIO().KeyShift);
    }
    ImGui::SetCursorScreenPos({area.right - 2 * area.side, area.at.y});
    if (row_icon(
            context, "lock", report + "/lock", row.locked ? ICON_LOCK : ICON_UNLOCK, row.locked, under,
            row.locked ? "Locked: is not moved or deleted by mistake" : "Lock, so that it is not moved by mistake"))
        context.editor.edit([&](edit::Document& d) { return edit::lock_node(d.file, row.node, !row.locked); });
    ImGui::SetCursorScreenPos({area.right - area.side, area.at.y});
    if (row_icon(context, "eye", report + "/eye", row.visible ? ICON_EYE : ICON_EYE_OFF, !row.visible, true,
                 row.visible ? "Hide, with all that hangs on it" : "Show"))
        context.editor.edit([&](edit::Document& d) { return edit::show_node(d.file, row.node, !row.visible); });
}

void draw_row(Context& context, StageTree& tree, const StageRow& row) {
    const RowArea area = area_of_row(row);
    const ImVec2 end(area.right, area.at.y + area.side);
    const bool selected = context.editor.selected() == row.node;
    const bool under = ImGui::IsWindowHovered() && ImGui::IsMouseHoveringRect(area.at, end);
    const bool dim = !row.visible || !row.ancestors_visible;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (selected || under)
        list.AddRectFilled(area.at, end, ImGui::GetColorU32(selected ? ImGuiCol_Header : ImGuiCol_HeaderHovered),
                           ImGui::GetStyle().FrameRounding);
    draw_caret(context, tree, row, area);
    const bool person = row.kind == NodeKind::kPerformer && !dim;
    list.AddText({area.icon_x, area.text_y}, person ? ui::kAccent : text_colour(dim), icon_of(row.kind));
    if (tree.renaming == row.node) {
        ImGui::SetCursorScreenPos({area.name_x - ImGui::GetStyle().FramePadding.x, area.at.y});
        name_field(context, tree, row, area.name_width());
    } else {
        draw_name(context, tree, row, area, dim);
    }
    draw_row_icons(context, row, area, under);
}

// Scrolls to the node that was selected elsewhere.
void scroll_to_selected(const Context& context, StageTree& tree, float row_height) {
    const auto selected = context.editor.selected();
    if (tree.scrolled_selected == selected) return;
    const auto row = selected ? row_of(tree.rows, *selected) : std::nullopt;
    if (selected && !row) return;  // its row has not been read yet
    tree.scrolled_selected = selected;
    if (!row) return;
    open_ancestors(tree.rows, *row, tree.closed);
    const std::vector<uint32_t> open = listed_rows(tree.rows, tree.closed);
    const auto index = std::find(open.begin(), open.end(), *row) - open.begin();
    scroll_to_row(static_cast<float>(index) * row_height, row_height);
}

void draw_tree(Context& context, StageTree& tree) {
    const float row_height = ImGui::GetFrameHeight();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 0});
    ImGui::BeginChild("tree");
    scroll_to_selected(context, tree, row_height);
    const std::vector<uint32_t> open = listed_rows(tree.rows, tree.closed);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(open.size()), row_height);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const StageRow& row = tree.rows[open[static_cast<size_t>(i)]];
            const float y = ImGui::GetCursorPosY();
            ImGui::PushID(static_cast<int>(row.node));
            draw_row(context, tree, row);
            ImGui::PopID();
            ImGui::SetCursorPosY(y + row_height);
        }
    clipper.End();
    if (ImGui::IsWindowHovered() && !ImGui::IsAnyItemHovered() && ImGui::IsMouseClicked(0)) context.editor.select({});
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

}  // namespace

void stage_panel(Context& context, const Area& area, StageTree& tree) {
    follow_document(context, tree);
    begin_panel("stage_panel", area);
    buttons(context, tree);
    ImGui::Separator();
    if (tree.rows.empty())
        ImGui::TextWrapped("%s", context.editor.is_open() ? "An empty stage. Drop a clip onto the image to begin."
                                                          : "Open or drop a stage or a clip to begin.");
    else
        draw_tree(context, tree);
    duplicate_dialog(context, tree);
    ImGui::End();
}

}  // namespace neuvv::viewer
