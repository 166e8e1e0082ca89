// The tab of light: a list of all lights, the fields of the selected one, and those of the whole stage.
#include <imgui.h>

#include <fmt/format.h>

#include "edit/light_values.h"
#include "media/colour.h"
#include "render/clips/light_status.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"
#include "tools/viewer/panels/stage_tree.h"

namespace neuvv::viewer {

namespace {

constexpr double kInitialRange_m = 10;
constexpr const char* kLightKinds[] = {"sun", "lamp", "spotlight"};  // by GltfLightKind

void drag(Context& context, uint32_t node, const edit::LightEdit& edit) {
    context.editor.drag([=](edit::Document& document) { return edit::set_light(document.file, node, edit); });
}

const char* unit_of(stage::GltfLightKind kind) {
    return kind == stage::GltfLightKind::kDirectional ? "%.1f lx" : "%.1f cd";
}

// The step of a drag is proportional to the intensity.
FieldGroup::NumberOptions intensity_options(const edit::LightValues& light) {
    return {0, 1e9, std::max(0.01, light.intensity / 200), unit_of(light.kind)};
}

void row_of_light(Context& context, const StageRow& row) {
    const edit::LightValues light = *edit::light_on(context.editor.file(), row.node);
    const std::string report = "light/" + row.title;
    const bool selected = context.editor.selected() == row.node;
    const float width = ImGui::GetContentRegionAvail().x, side = ImGui::GetFrameHeight();
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    bool on = row.visible;
    ImGui::BeginDisabled(!row.ancestors_visible);
    if (ImGui::Checkbox("##on", &on))
        context.editor.edit([&](edit::Document& d) { return edit::show_node(d.file, row.node, on); });
    context.report.item(report + "/on");
    explain(on ? "Switch off" : "Switch on");
    ImGui::EndDisabled();
    ImGui::SameLine(0, gap);
    const glm::dvec3 srgb = media::srgb_from_linear(light.color);
    float rgb[3] = {static_cast<float>(srgb.x), static_cast<float>(srgb.y), static_cast<float>(srgb.z)};
    if (ImGui::ColorEdit3("##colour", rgb,
                          ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_Float))
        drag(context, row.node, {.color = media::linear_from_srgb(glm::max(glm::dvec3(rgb[0], rgb[1], rgb[2]), 0.0))});
    context.report.item(report + "/colour");
    ImGui::SameLine(0, gap);
    const float number = std::round(0.3f * width);
    if (ImGui::Selectable(row.title.c_str(), selected, 0, {width - number - 2 * side - 3 * gap, 0}))
        context.editor.select(row.node);
    context.report.item(report);
    ImGui::SameLine(0, gap);
    ImGui::SetNextItemWidth(-FLT_MIN);
    double intensity = light.intensity;
    const FieldGroup::NumberOptions options = intensity_options(light);
    if (ImGui::DragScalar("##intensity", ImGuiDataType_Double, &intensity, static_cast<float>(options.step),
                          &options.low, &options.high, options.format, ImGuiSliderFlags_AlwaysClamp))
        drag(context, row.node, {.intensity = intensity});
    if (ImGui::IsItemActivated()) context.editor.end_drag();
    context.report.item(report + "/intensity");
}

void list_of_lights(Context& context, const StageTree& tree) {
    headline("Lights");
    bool any = false;
    for (const StageRow& row : tree.rows) {
        if (!edit::light_on(context.editor.file(), row.node)) continue;
        any = true;
        ImGui::PushID(static_cast<int>(row.node));
        row_of_light(context, row);
        ImGui::PopID();
    }
    if (!any) ImGui::TextWrapped("No lights. Add one with " ICON_LIGHT " above the tree.");
}

void kind_field(Context& context, FieldGroup& group, uint32_t node, const edit::LightValues& light) {
    auto kind = static_cast<size_t>(light.kind);
    if (!group.choice("kind", kind, kLightKinds)) return;
    const auto new_kind = static_cast<stage::GltfLightKind>(kind);
    edit::LightEdit edit;
    edit.kind = edit::kLightKindNames[kind];
    // Intensities in lux and in candela are of different magnitude.
    if ((new_kind == stage::GltfLightKind::kDirectional) != (light.kind == stage::GltfLightKind::kDirectional))
        edit.intensity = edit::usual_intensity(new_kind);
    context.editor.edit([&](edit::Document& d) { return edit::set_light(d.file, node, edit); });
}

void spot_fields(Context& context, FieldGroup& group, uint32_t node, const edit::LightValues& light) {
    double beam_deg = 2 * light.outer_cone_deg,
           softness = edit::softness_of(light.inner_cone_deg, light.outer_cone_deg);
    const auto change = [&] {
        edit::LightEdit edit;
        edit.outer_cone_deg = beam_deg / 2;
        edit.inner_cone_deg = edit::inner_cone_for(softness, beam_deg / 2);
        drag(context, node, edit);
    };
    if (group.number("beam", beam_deg, {1, 180, 0.2, "%.1f°"})) change();
    explain("From edge to edge of its cone");
    if (group.slider("softness", softness, 0, 1)) change();
    explain("How much of the cone fades towards its edge");
}

void shadow_line(Context& context, FieldGroup& group, uint32_t node) {
    const stage::Stage* const stage = context.stage_of_document();
    if (!stage) return;
    const std::vector<render::LightStatus> statuses = render::light_statuses(*stage, context.frame.evaluated);
    for (size_t i = 0; i < statuses.size(); ++i) {
        if (context.frame.evaluated.lights[i].node != node) continue;
        group.label("");
        const render::LightStatus& status = statuses[i];
        const std::string text = !status.text.empty()  ? status.text
                                 : status.casts_shadow ? "casts shadows"
                                                       : "casts no shadows";
        if (!status.text.empty()) ImGui::PushStyleColor(ImGuiCol_Text, ui::kWarning);
        ImGui::TextWrapped("%s", text.c_str());
        if (!status.text.empty()) ImGui::PopStyleColor();
        group.report_last("shadow");
    }
}

void selected_light(Context& context, FieldGroup& group, const StageTree& tree) {
    const auto node = context.editor.selected();
    const auto at = node ? row_of(tree.rows, *node) : std::nullopt;
    const auto light = at ? edit::light_on(context.editor.file(), *node) : std::nullopt;
    if (!light) return;
    ImGui::PushID(static_cast<int>(*node));
    headline(tree.rows[*at].title.c_str());
    kind_field(context, group, *node, *light);
    glm::dvec3 color = light->color;
    if (group.colour("colour", color)) drag(context, *node, {.color = color});
    double intensity = light->intensity;
    if (group.number("intensity", intensity, intensity_options(*light))) drag(context, *node, {.intensity = intensity});
    if (light->kind != stage::GltfLightKind::kDirectional) {
        double range_m = light->range_m;
        if (group.number("range", range_m, {0, 1e4, 0.05, range_m > 0 ? "%.2f m" : "endless"})) {
            // A drag from "endless" begins at a large range, not near the lamp.
            if (light->range_m == 0 && range_m > 0 && range_m < 0.5) range_m = kInitialRange_m;
            if (range_m < 0.01) range_m = 0;
            drag(context, *node, {.range_m = range_m});
        }
        explain("Beyond it there is no light of it; 0: endless");
    }
    if (light->kind == stage::GltfLightKind::kSpot) spot_fields(context, group, *node, *light);
    shadow_line(context, group, *node);
    ImGui::PopID();
}

}  // namespace

void light_tab(Context& context, StageTree& tree) {
    if (!context.editor.is_open()) return;
    follow_document(context, tree);
    FieldGroup group(context, "light");
    list_of_lights(context, tree);
    selected_light(context, group, tree);
    headline("Everywhere");
    stage_light_fields(context, group);
}

}  // namespace neuvv::viewer
