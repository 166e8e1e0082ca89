#include "tools/headset/panel/panel_rows.h"

#include <fmt/format.h>

namespace neuvv::headset {

void Rows::record_item(const char* name) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax(), size = ImGui::GetIO().DisplaySize;
    result.items[name] = {0.5 * (low.x + high.x) / size.x, 0.5 * (low.y + high.y) / size.y};
}

bool Rows::button(const char* name, const char* label, float width, bool is_on) {
    ImGui::PushID(name);
    if (is_on) {
        ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    }
    const bool pressed = ImGui::Button(label, {width, ImGui::GetFrameHeight() * 1.2f});
    if (ImGui::CalcTextSize(label, nullptr, true).x > width) result.cut_off.emplace_back(label);
    if (is_on) ImGui::PopStyleColor(2);
    ImGui::PopID();
    record_item(name);
    return pressed;
}

bool Rows::icon_button(const char* name, const char* label, const char* tooltip, float width, bool is_on) {
    const bool pressed = button(name, label, width, is_on);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tooltip);
    return pressed;
}

bool Rows::toggle(const char* name, const char* label, float width, bool& value) {
    const bool pressed = button(name, label, width, value);
    if (pressed) value = !value;
    return pressed;
}

bool Rows::checkbox(const char* name, const char* label, bool* value) {
    const bool changed = ImGui::Checkbox(label, value);
    record_item(name);
    return changed;
}

bool Rows::slider(const char* name, const char* format, double& value, double low, double high,
                  ImGuiSliderFlags flags) {
    ImGui::PushID(name);
    ImGui::SetNextItemWidth(-1);
    const bool changed = ImGui::SliderScalar("##value", ImGuiDataType_Double, &value, &low, &high, format, flags);
    ImGui::PopID();
    record_item(name);
    return changed;
}

void Rows::edit_slider(const char* name, const char* format, double value, double low, double high,
                       const std::function<std::string(edit::Document&, double)>& operation, ImGuiSliderFlags flags) {
    const bool changed = slider(name, format, value, low, high, flags);
    drag_by_item(changed, [&](edit::Document& document) { return operation(document, value); });
}

void Rows::drag_by_item(bool changed, const editor::Editor::Operation& operation) {
    if (changed) state.slider_edits |= state.editor.drag(operation);
    slider_held |= ImGui::IsItemActive();
}

float column_width(int columns) {
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    return (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns);
}

std::vector<float> fitted_widths(const std::vector<const char*>& labels) {
    std::vector<float> widths;
    float left =
        ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x * static_cast<float>(labels.size() - 1);
    for (const char* label : labels) {
        widths.push_back(ImGui::CalcTextSize(label).x);
        left -= widths.back();
    }
    for (float& width : widths) width += left / static_cast<float>(labels.size());
    return widths;
}

const stage::StagePerformer* selected_performer(const HeadsetState& state) {
    const auto performer = state.selected_performer();
    return performer ? &state.stage->performers[*performer] : nullptr;
}

void performer_title(const HeadsetState& state) {
    const stage::StagePerformer* performer = selected_performer(state);
    if (!performer) return ImGui::TextDisabled("Point at a performer and pull the trigger.");
    const double seconds = state.frame_of(*state.selected_performer()) / state.stage->clips[performer->clip].fps;
    ImGui::Text("%s", performer->name.c_str());
    ImGui::SameLine();
    ImGui::TextDisabled("%s", fmt::format("shows {:.2f} s of its clip", seconds).c_str());
}

}  // namespace neuvv::headset
