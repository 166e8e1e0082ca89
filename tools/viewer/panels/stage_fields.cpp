// The fields of the whole stage.
#include <imgui.h>

#include "tools/viewer/panels/property_fields.h"

namespace neuvv::viewer {

namespace {

void drag(Context& context, const edit::StageEdit& edit) {
    context.editor.drag([edit](edit::Document& document) { return edit::set_stage(document.file, edit); });
}

void set(Context& context, const edit::StageEdit& edit) {
    context.editor.edit([edit](edit::Document& document) { return edit::set_stage(document.file, edit); });
}

void time_fields(Context& context, FieldGroup& group, const stage::StageSettings& settings) {
    double duration_s = settings.duration_s.value_or(context.view.clock.duration_s());
    if (group.number("duration", duration_s, {1 / stage::kMaxStageFps, stage::kMaxStageSeconds, 0.02, "%.2f s"}))
        drag(context, {.duration_s = duration_s});
    if (!settings.duration_s) explain("Until all performers are at their end, as long as you give no other");
    double fps = settings.fps.value_or(context.view.clock.fps());
    if (group.number("frame rate", fps, {1, 240, 0.1, "%.3g fps"})) drag(context, {.fps = fps});
}

void environment_fields(Context& context, FieldGroup& group, const stage::StageEnvironment& environment) {
    group.label("environment");
    ImGui::TextDisabled("%s", std::filesystem::path(stage::decoded_uri(environment.uri)).filename().string().c_str());
    group.report_last("environment");
    double intensity = environment.intensity;
    if (group.number("intensity", intensity, {0, 1000, 0.01, "%.2f"}))
        drag(context, {.environment_intensity = intensity});
    double rotation_deg = environment.rotation_deg;
    if (group.number("turned by", rotation_deg, {-360, 360, 0.5, "%.1f°"}))
        drag(context, {.environment_rotation_deg = rotation_deg});
    group.label("");
    if (ImGui::Button("No environment")) set(context, {.environment = std::filesystem::path()});
    group.report_last("no environment");
}

}  // namespace

void stage_light_fields(Context& context, FieldGroup& group) {
    const stage::StageSettings settings = edit::stage_settings_of(context.editor.file());
    glm::dvec3 ambient = settings.ambient.value_or(context.frame.stage ? context.frame.stage->ambient : glm::dvec3(0));
    if (group.colour("ambient", ambient)) drag(context, {.ambient = ambient});
    explain("Light that comes from everywhere");
    if (settings.environment) environment_fields(context, group, *settings.environment);
    bool shadows = settings.shadows, falloff = settings.falloff;
    if (group.toggle("shadows", shadows)) set(context, {.shadows = shadows});
    explain("Lights cast shadows");
    if (group.toggle("falloff", falloff)) set(context, {.falloff = falloff});
    explain("Lights shine on performers; without, they look as they were filmed");
}

void stage_fields(Context& context, FieldGroup& group) {
    const stage::StageSettings settings = edit::stage_settings_of(context.editor.file());
    headline("Stage");
    time_fields(context, group, settings);
    glm::dvec3 background = settings.background;
    if (group.colour("background", background)) drag(context, {.background = background});
    auto blend = static_cast<size_t>(settings.blend);
    constexpr const char* kBlends[] = {"exact", "layer over layer"};  // by StageBlend
    if (group.choice("blend", blend, kBlends)) set(context, {.blend = static_cast<stage::StageBlend>(blend)});
    explain("How performers who are in each other's way mix");
    headline("Light");
    stage_light_fields(context, group);
}

}  // namespace neuvv::viewer
