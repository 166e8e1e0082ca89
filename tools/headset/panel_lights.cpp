// The panel's page of the selected light or camera: brightness, colour and cone; the field of view.
#include "edit/light_values.h"
#include "media/colour.h"
#include "tools/headset/markers.h"
#include "tools/headset/panel_rows.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr double kMinCone_deg = 2, kMaxCone_deg = 90, kMinView_deg = 10, kMaxView_deg = 120;

void colour_picker(Rows& rows, uint32_t node, const edit::LightValues& light) {
    ImGui::SetNextItemWidth(0.3f * ImGui::GetContentRegionAvail().x);
    glm::vec3 colour(media::srgb_from_linear(light.color));
    const bool changed = ImGui::ColorPicker3("##colour", &colour.x,
                                             ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                                                 ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoAlpha);
    rows.drag_by_item(changed, [&](edit::Document& document) {
        return edit::set_light(document.file, node, {.color = media::linear_from_srgb(colour)});
    });
    rows.record_item("light colour");
}

void light_values_rows(Rows& rows, uint32_t node, const edit::LightValues& light) {
    colour_picker(rows, node, light);
    ImGui::SameLine();
    ImGui::BeginGroup();
    const bool directional = light.kind == stage::GltfLightKind::kDirectional;
    const double usual = edit::usual_intensity(light.kind);
    rows.edit_slider(
        "brightness", directional ? "%.2f lux" : "%.1f candela", light.intensity, usual / 100, usual * 100,
        [node](edit::Document& document, double intensity) {
            return edit::set_light(document.file, node, {.intensity = intensity});
        },
        ImGuiSliderFlags_Logarithmic);
    if (light.kind == stage::GltfLightKind::kSpot)
        rows.edit_slider("cone", "half angle %.0f°", light.outer_cone_deg, kMinCone_deg, kMaxCone_deg,
                         [&](edit::Document& document, double outer_deg) {
                             const double softness = edit::softness_of(light.inner_cone_deg, light.outer_cone_deg);
                             return edit::set_light(document.file, node,
                                                    {.inner_cone_deg = edit::inner_cone_for(softness, outer_deg),
                                                     .outer_cone_deg = outer_deg});
                         });
    ImGui::EndGroup();
}

}  // namespace

void lights_rows(Rows& rows) {
    const auto node = selected_marker(rows.state);
    if (!node)
        return ImGui::TextWrapped(
            "Point at a light or a camera and pull the trigger to select it; the grip holds it. With the trigger "
            "pulled "
            "on anything else, the selected one looks there.");
    const stage::StageFile& file = rows.state.editor.file();
    ImGui::TextUnformatted(edit::node_title(file, *node).c_str());
    if (const auto light = edit::light_on(file, *node)) light_values_rows(rows, *node, *light);
    const auto camera = edit::camera_on(file, *node);
    if (camera && !camera->orthographic)
        rows.edit_slider("field of view", "field of view %.0f°", glm::degrees(camera->vertical_angle_rad), kMinView_deg,
                         kMaxView_deg, [node](edit::Document& document, double degrees) {
                             return edit::set_camera(document.file, *node, glm::radians(degrees));
                         });
}

}  // namespace neuvv::headset
