#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/node_actions.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

const char* sign_of(NodeKind kind) {
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

void light_menu(Viewer& viewer) {
    const auto item = [&](const char* name, const char* report) {
        const bool chosen = ImGui::MenuItem(name);
        viewer.report.item(report);
        return chosen;
    };
    if (item(ICON_LIGHT "  Spotlight", "stage/add/spot")) add_light_in_view(viewer, stage::GltfLightKind::kSpot);
    if (item(ICON_BULLET "  Lamp", "stage/add/point")) add_light_in_view(viewer, stage::GltfLightKind::kPoint);
    if (item(ICON_SUN "  Sun", "stage/add/sun")) add_light_in_view(viewer, stage::GltfLightKind::kDirectional);
}

void buttons(Viewer& viewer) {
    const auto node = viewer.editor.selected();
    const bool open = viewer.editor.is_open();
    if (icon_button(viewer, "stage/add_light", ICON_LIGHT, "Add a light", false, open)) ImGui::OpenPopup("lights");
    ImGui::SameLine();
    if (icon_button(viewer, "stage/add_camera", ICON_CAMERA, "Add a camera that sees what you see now", false, open))
        add_camera_in_view(viewer);
    if (ImGui::BeginPopup("lights")) {
        light_menu(viewer);
        ImGui::EndPopup();
    }
    ImGui::SameLine();
    if (icon_button(viewer, "stage/duplicate", ICON_COPY, "Duplicate in a row, a ring or a fan (one more: Ctrl+D)",
                    false, node.has_value()))
        ask_duplicate(viewer, *node);
    ImGui::SameLine();
    if (icon_button(viewer, "stage/delete", ICON_TRASH, "Delete (Del)", false, node.has_value()))
        delete_node(viewer, *node);
}

void menu_of(Viewer& viewer, const StageRow& row) {
    const std::string name = "stage/menu/";
    const auto item = [&](const char* title, const char* keys) {
        const bool chosen = ImGui::MenuItem(title, keys);
        viewer.report.item(name + title);
        return chosen;
    };
    if (item("Rename", "F2")) begin_renaming(viewer, row.node);
    if (item("Duplicate", "Ctrl+D")) duplicate_once(viewer, row.node);
    if (item("Duplicate…", "")) ask_duplicate(viewer, row.node);
    if (item(row.shown ? "Hide" : "Show", ""))
        viewer.editor.edit([&](edit::Document& d) { return edit::show_node(d.file, row.node, !row.shown); });
    if (item(row.locked ? "Unlock" : "Lock", ""))
        viewer.editor.edit([&](edit::Document& d) { return edit::lock_node(d.file, row.node, !row.locked); });
    ImGui::Separator();
    if (item("Delete", "Del")) delete_node(viewer, row.node);
}

// A sign at a row's end, faint where it says nothing unusual and the row is not under the pointer.
bool mark(Viewer& viewer, const char* id, const std::string& report, const char* sign, bool strong, bool seen,
          const char* explained) {
    const float side = ImGui::GetFrameHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool pressed = ImGui::InvisibleButton(id, {side, side});
    viewer.report.item(report);
    const bool hovered = ImGui::IsItemHovered();
    if (hovered) ImGui::SetTooltip("%s", explained);
    if (seen || hovered || strong) {
        const ImVec2 size = ImGui::CalcTextSize(sign);
        ImGui::GetWindowDrawList()->AddText(
            {std::round(at.x + 0.5f * (side - size.x)), std::round(at.y + 0.5f * (side - size.y))},
            text_colour(!strong && !hovered), sign);
    }
    return pressed;
}

// The text, cut with an ellipsis where it is too long; whether it was.
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

void name_field(Viewer& viewer, const StageRow& row, float width) {
    StageTree& tree = viewer.stage_tree;
    ImGui::SetNextItemWidth(width);
    const bool begins = std::exchange(tree.begin_typing, false);
    if (begins) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##name", &tree.typed,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    viewer.report.item("stage/" + row.title + "/name");
    if (!entered && !ImGui::IsItemDeactivated()) return;
    const std::string typed = tree.typed;
    tree.renaming.reset();
    if (typed != row.title && !typed.empty())
        viewer.editor.edit([&](edit::Document& d) { return edit::rename_node(d.file, row.node, typed); });
}

// Where a row's parts are.
struct RowArea {
    ImVec2 at;
    float right, side, sign_x, name_x, text_y;
    float name_width() const { return std::max(1.0f, right - 2 * side - name_x); }
};

RowArea place_of_row(const StageRow& row) {
    constexpr uint32_t kDeepest = 12;  // further in there were no room for names
    RowArea place;
    place.at = ImGui::GetCursorScreenPos();
    place.right = place.at.x + ImGui::GetContentRegionAvail().x;
    place.side = ImGui::GetFrameHeight();
    place.sign_x = place.at.x + (static_cast<float>(std::min(row.depth, kDeepest)) + 1) * std::round(0.7f * place.side);
    place.name_x = place.sign_x + std::round(place.side);
    place.text_y = place.at.y + ImGui::GetStyle().FramePadding.y;
    return place;
}

// Opens and closes what hangs on the row.
void draw_caret(Viewer& viewer, const StageRow& row, const RowArea& place) {
    if (row.below == 0) return;
    std::set<std::string>& closed = viewer.stage_tree.closed;
    const bool is_closed = closed.contains(row.title);
    const float width = std::round(0.7f * place.side);
    ImGui::SetCursorScreenPos({place.sign_x - width, place.at.y});
    if (ImGui::InvisibleButton("open", {width, place.side})) {
        if (is_closed)
            closed.erase(row.title);
        else
            closed.insert(row.title);
    }
    viewer.report.item("stage/" + row.title + "/open");
    ImGui::GetWindowDrawList()->AddText({place.sign_x - width + 0.2f * place.side, place.text_y}, text_colour(true),
                                        is_closed ? ICON_CARET_RIGHT : ICON_CARET_DOWN);
}

void draw_name(Viewer& viewer, const StageRow& row, const RowArea& place, bool dim) {
    ImGui::SetCursorScreenPos({place.sign_x, place.at.y});
    ImGui::InvisibleButton("row", {place.name_x - place.sign_x + place.name_width(), place.side},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    viewer.report.item("stage/" + row.title);
    const bool hovered = ImGui::IsItemHovered();
    const bool cut = cut_text({place.name_x, place.text_y}, place.name_width() - ImGui::GetStyle().ItemSpacing.x,
                              text_colour(dim), row.title);
    if (cut && hovered) ImGui::SetTooltip("%s", row.title.c_str());
    if (hovered && (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1))) {
        viewer.stage_tree.seen_selected = row.node;
        viewer.editor.select(row.node);
    }
    if (hovered && ImGui::IsMouseDoubleClicked(0)) begin_renaming(viewer, row.node);
    const ImVec2 spacing = ImGui::GetStyle().ItemSpacing;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {spacing.x, 0.8f * spacing.x});  // a menu's rows, not the tree's
    if (ImGui::BeginPopupContextItem("menu")) {
        menu_of(viewer, row);
        ImGui::EndPopup();
    }
    ImGui::PopStyleVar();
}

void draw_marks(Viewer& viewer, const StageRow& row, const RowArea& place, bool under) {
    const std::string report = "stage/" + row.title;
    ImGui::SetCursorScreenPos({place.right - 2 * place.side, place.at.y});
    if (mark(viewer, "lock", report + "/lock", row.locked ? ICON_LOCK : ICON_UNLOCK, row.locked, under,
             row.locked ? "Locked: is not moved or deleted by mistake" : "Lock, so that it is not moved by mistake"))
        viewer.editor.edit([&](edit::Document& d) { return edit::lock_node(d.file, row.node, !row.locked); });
    ImGui::SetCursorScreenPos({place.right - place.side, place.at.y});
    if (mark(viewer, "eye", report + "/eye", row.shown ? ICON_EYE : ICON_EYE_OFF, !row.shown, true,
             row.shown ? "Hide, with all that hangs on it" : "Show"))
        viewer.editor.edit([&](edit::Document& d) { return edit::show_node(d.file, row.node, !row.shown); });
}

void draw_row(Viewer& viewer, const StageRow& row) {
    const RowArea place = place_of_row(row);
    const ImVec2 end(place.right, place.at.y + place.side);
    const bool selected = viewer.editor.selected() == row.node;
    const bool under = ImGui::IsWindowHovered() && ImGui::IsMouseHoveringRect(place.at, end);
    const bool dim = !row.shown || !row.shown_above;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (selected || under)
        list.AddRectFilled(place.at, end, ImGui::GetColorU32(selected ? ImGuiCol_Header : ImGuiCol_HeaderHovered),
                           ImGui::GetStyle().FrameRounding);
    draw_caret(viewer, row, place);
    const bool person = row.kind == NodeKind::kPerformer && !dim;
    list.AddText({place.sign_x, place.text_y}, person ? ui::kAccent : text_colour(dim), sign_of(row.kind));
    if (viewer.stage_tree.renaming == row.node) {
        ImGui::SetCursorScreenPos({place.name_x - ImGui::GetStyle().FramePadding.x, place.at.y});
        name_field(viewer, row, place.name_width());
    } else {
        draw_name(viewer, row, place, dim);
    }
    draw_marks(viewer, row, place, under);
}

// Brings what was selected elsewhere into sight.
void scroll_to_selected(Viewer& viewer, float row_height) {
    StageTree& tree = viewer.stage_tree;
    const auto selected = viewer.editor.selected();
    if (tree.seen_selected == selected) return;
    const auto row = selected ? row_of(tree.rows, *selected) : std::nullopt;
    if (selected && !row) return;  // it is added in this frame
    tree.seen_selected = selected;
    if (!row) return;
    open_above(tree.rows, *row, tree.closed);
    const std::vector<uint32_t> open = open_rows(tree.rows, tree.closed);
    const auto place = std::find(open.begin(), open.end(), *row) - open.begin();
    const float top = static_cast<float>(place) * row_height, bottom = top + row_height;
    const float seen = ImGui::GetWindowHeight();
    if (top < ImGui::GetScrollY() || bottom > ImGui::GetScrollY() + seen)
        ImGui::SetScrollY(std::max(0.0f, top - 0.5f * (seen - row_height)));
}

void tree_of(Viewer& viewer) {
    StageTree& tree = viewer.stage_tree;
    const float row_height = ImGui::GetFrameHeight();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 0});
    ImGui::BeginChild("tree");
    scroll_to_selected(viewer, row_height);
    const std::vector<uint32_t> open = open_rows(tree.rows, tree.closed);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(open.size()), row_height);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++) {
            const StageRow& row = tree.rows[open[static_cast<size_t>(i)]];
            const float y = ImGui::GetCursorPosY();
            ImGui::PushID(static_cast<int>(row.node));
            draw_row(viewer, row);
            ImGui::PopID();
            ImGui::SetCursorPosY(y + row_height);
        }
    clipper.End();
    if (ImGui::IsWindowHovered() && !ImGui::IsAnyItemHovered() && ImGui::IsMouseClicked(0)) viewer.editor.select({});
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

}  // namespace

void stage_panel(Viewer& viewer, const Area& area) {
    const StageTree& tree = viewer.stage_tree;
    follow_document(viewer);
    begin_panel("stage_panel", area);
    buttons(viewer);
    ImGui::Separator();
    if (tree.rows.empty())
        ImGui::TextWrapped("%s", viewer.editor.is_open()
                                     ? "An empty stage. Drop a clip (.nvv, .npz) onto the image to begin."
                                     : "Open or drop a stage or a clip to begin.");
    else
        tree_of(viewer);
    duplicate_dialog(viewer);
    ImGui::End();
}

}  // namespace neuvv::viewer
