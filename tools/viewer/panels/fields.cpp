#include "tools/viewer/panels/fields.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "media/colour.h"
#include "tools/viewer/context.h"

namespace neuvv::viewer {

namespace {

constexpr float kLabelShare = 0.36f;

// The text field that is being edited, and its text. ImGui edits one field at a time.
ImGuiID typing = 0;
std::string typed_text;

}  // namespace

FieldGroup::FieldGroup(Context& context, std::string name) : context_(context), name_(std::move(name)) {
    ImGui::PushID(name_.c_str());
}

FieldGroup::~FieldGroup() {
    ImGui::PopID();
}

void FieldGroup::label(const char* name) {
    const float width = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
    ImGui::AlignTextToFramePadding();
    std::string text = name;
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    ImGui::TextUnformatted(text.c_str());
    ImGui::SameLine(std::round(kLabelShare * width));
    ImGui::SetNextItemWidth(-FLT_MIN);
}

void FieldGroup::report_last(const char* name) {
    // The Tab key goes to the next field during a drag; the change of each field is a step of its own.
    if (ImGui::IsItemActivated()) context_.editor.end_drag();
    context_.report.item(name_ + "/" + name);
}

bool FieldGroup::number(const char* name, double& value, const NumberOptions& options) {
    label(name);
    ImGui::PushID(name);
    const bool changed = ImGui::DragScalar("##", ImGuiDataType_Double, &value, static_cast<float>(options.step),
                                           &options.low, &options.high, options.format, ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();
    report_last(name);
    return changed;
}

bool FieldGroup::number(const char* name, glm::dvec3& value, const NumberOptions& options) {
    label(name);
    ImGui::PushID(name);
    const bool changed = ImGui::DragScalarN("##", ImGuiDataType_Double, &value.x, 3, static_cast<float>(options.step),
                                            &options.low, &options.high, options.format, ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();
    report_last(name);
    return changed;
}

bool FieldGroup::colour(const char* name, glm::dvec3& value) {
    label(name);
    const glm::dvec3 srgb = media::srgb_from_linear(value);
    float rgb[3] = {static_cast<float>(srgb.x), static_cast<float>(srgb.y), static_cast<float>(srgb.z)};
    ImGui::PushID(name);
    const bool changed = ImGui::ColorEdit3("##", rgb, ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_Float);
    ImGui::PopID();
    report_last(name);
    if (changed) value = media::linear_from_srgb(glm::max(glm::dvec3(rgb[0], rgb[1], rgb[2]), 0.0));
    return changed;
}

bool FieldGroup::toggle(const char* name, bool& value) {
    label(name);
    ImGui::PushID(name);
    const bool changed = ImGui::Checkbox("##", &value);
    ImGui::PopID();
    report_last(name);
    return changed;
}

bool FieldGroup::choice(const char* name, size_t& value, std::span<const char* const> of) {
    label(name);
    ImGui::PushID(name);
    bool changed = false;
    const bool open = ImGui::BeginCombo("##", value < of.size() ? of[value] : "");
    report_last(name);
    if (open) {
        for (size_t i = 0; i < of.size(); ++i) {
            if (ImGui::Selectable(of[i], i == value)) {
                changed = i != value;
                value = i;
            }
            report_last((std::string(name) + "/" + of[i]).c_str());
        }
        ImGui::EndCombo();
    }
    ImGui::PopID();
    return changed;
}

// ImGui forgets what was typed when a click elsewhere ends the editing, so the text is kept in `typed_text`.
bool FieldGroup::text(const char* name, std::string& value) {
    label(name);
    ImGui::PushID(name);
    const ImGuiID id = ImGui::GetID("##");
    std::string text = typing == id ? typed_text : value;
    ImGui::InputText("##", &text);
    const bool changed = ImGui::IsItemDeactivatedAfterEdit() && text != value;
    if (ImGui::IsItemActive()) {
        typing = id;
        typed_text = text;
    } else if (typing == id) {
        typing = 0;
    }
    ImGui::PopID();
    report_last(name);
    if (changed) value = text;
    return changed;
}

bool FieldGroup::slider(const char* name, double& value, double low, double high, const char* format) {
    label(name);
    ImGui::PushID(name);
    const bool changed =
        ImGui::SliderScalar("##", ImGuiDataType_Double, &value, &low, &high, format, ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();
    report_last(name);
    return changed;
}

bool icon_button(Context& context, const char* name, const char* icon, const char* tooltip, bool on, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_ButtonActive]);
    ImGui::PushID(name);
    const float side = ImGui::GetFrameHeight();
    const bool pressed = ImGui::Button(icon, {std::round(1.25f * side), side});
    ImGui::PopID();
    if (on) ImGui::PopStyleColor();
    context.report.item(name);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", tooltip);
    ImGui::EndDisabled();
    return pressed;
}

bool text_button(Context& context, const char* name, const char* text, bool enabled, float width) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(text, {width, 0});
    ImGui::EndDisabled();
    context.report.item(name);
    return pressed;
}

bool menu_item(Context& context, const std::string& report, const char* text, const char* keys, bool on, bool enabled) {
    const bool clicked = ImGui::MenuItem(text, keys, on, enabled);
    context.report.item(report);
    return clicked;
}

}  // namespace neuvv::viewer
