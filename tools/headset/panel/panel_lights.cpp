// The panel's page of lights and cameras: brightness, colour and cone; the field of view. Its rows are the same
// whatever is selected; those that have no use for it are grey.
#include "edit/light_values.h"
#include "media/colour.h"
#include "tools/headset/draw/markers.h"
#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/opening.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

void colour_picker(Rows& rows, uint32_t node, const std::optional<edit::LightValues>& light) {
    ImGui::BeginDisabled(!light);
    ImGui::SetNextItemWidth(0.3f * ImGui::GetContentRegionAvail().x);
    glm::vec3 colour(light ? media::srgb_from_linear(light->color) : glm::dvec3(0.5));
    const bool changed = ImGui::ColorPicker3("##colour", &colour.x,
                                             ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                                                 ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoAlpha);
    rows.drag_by_item(changed, [&](edit::Document& document) {
        return edit::set_light(document.file, node, {.color = media::linear_from_srgb(colour)});
    });
    rows.record_item("light colour");
    ImGui::EndDisabled();
}

void brightness_row(Rows& rows, uint32_t node, const std::optional<edit::LightValues>& light) {
    const bool directional = light && light->kind == stage::GltfLightKind::kDirectional;
    const double usual = edit::usual_intensity(light ? light->kind : stage::GltfLightKind::kPoint);
    ImGui::BeginDisabled(!light);
    rows.edit_slider(
        "brightness",
        !light        ? "brightness"
        : directional ? "%.2f lux"
                      : "%.1f candela",
        light ? light->intensity : usual, usual / 100, usual * 100,
        [node](edit::Document& document, double intensity) {
            return edit::set_light(document.file, node, {.intensity = intensity});
        },
        ImGuiSliderFlags_Logarithmic);
    ImGui::EndDisabled();
}

using SetOpening = std::string (*)(stage::StageFile& file, uint32_t node, double degrees);
void opening_row(Rows& rows, uint32_t node, const std::optional<Opening>& opening, const char* name, const char* format,
                 SetOpening set) {
    const Opening shown = opening.value_or(Opening{0, 0, 1, ""});
    ImGui::BeginDisabled(!opening);
    rows.edit_slider(name, opening ? format : name, shown.degrees, shown.low, shown.high,
                     [&](edit::Document& document, double degrees) { return set(document.file, node, degrees); });
    ImGui::EndDisabled();
}

}  // namespace

void lights_rows(Rows& rows) {
    const auto selected = selected_marker(rows.state);
    const stage::StageFile& file = rows.state.editor.file();
    if (selected)
        ImGui::TextUnformatted(edit::node_title(file, *selected).c_str());
    else
        ImGui::TextDisabled("Point at a light or a camera and pull the trigger.");
    const uint32_t node = selected.value_or(0);
    const auto light = selected ? edit::light_on(file, node) : std::nullopt;
    const auto cone = selected ? opening_of_spot(file, node) : std::nullopt;
    const auto view = selected ? opening_of_camera(file, node) : std::nullopt;
    colour_picker(rows, node, light);
    ImGui::SameLine();
    ImGui::BeginGroup();
    brightness_row(rows, node, light);
    opening_row(rows, node, cone, "cone", "half angle %.0f°", set_cone);
    opening_row(rows, node, view, "field of view", "field of view %.0f°", set_opening);
    ImGui::EndGroup();
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped(
        "The grip holds it: the stick pushes it away, and sideways widens its cone or its view. With the trigger "
        "pulled on anything else, the selected one looks there.");
    ImGui::PopStyleColor();
}

}  // namespace neuvv::headset
