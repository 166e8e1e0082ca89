// The fields of a performer: its clip, its time map, and how it is drawn.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/property_fields.h"

namespace neuvv::viewer {

namespace {

void drag(Context& context, uint32_t node, const edit::PerformerEdit& edit) {
    context.editor.drag([=](edit::Document& document) { return edit::set_performer(document.file, node, edit); });
}

void set(Context& context, uint32_t node, const edit::PerformerEdit& edit) {
    context.editor.edit([=](edit::Document& document) { return edit::set_performer(document.file, node, edit); });
}

// The clip of a performer as it was read; null while it is being read.
const stage::StageClip* clip_on(const Context& context, uint32_t node) {
    const stage::Stage* stage = context.stage_of_document();
    if (!stage) stage = context.frame.stage.get();
    if (!stage) return nullptr;
    for (const stage::StagePerformer& performer : stage->performers)
        if (performer.node == node) return &stage->clips[performer.clip];
    return nullptr;
}

void clip_lines(const stage::StageClip* clip, FieldGroup& group, const stage::PerformerSettings& settings) {
    const std::string name = std::filesystem::path(stage::decoded_uri(settings.uri)).filename().string();
    group.label("clip");
    ImGui::TextUnformatted(name.c_str());
    group.report_last("clip");
    explain(clip ? clip->path.c_str() : settings.uri.c_str());
    if (!clip) return;
    const glm::dvec3& size = clip->box_size;
    const std::string lines = fmt::format("{} frames, {:.4g} fps, {:.4g} s\n{:.2f} × {:.2f} × {:.2f} m", clip->frames,
                                          clip->fps, clip->frames / clip->fps, size.x, size.y, size.z);
    group.label("");
    ImGui::TextDisabled("%s", lines.c_str());
    explain("Width, height and depth of the space that was captured");
}

// What is wrong with a time map for this clip; empty: nothing.
std::string error_of(const stage::TimeMap& map, const stage::StageClip* clip) {
    try {
        if (clip) stage::timeline_of(map, clip->frames, clip->fps, "", "");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// Sets the time map that was typed, or remembers it with its error.
void try_time(Context& context, PropertyFields::Time& time, uint32_t node, const stage::StageClip* clip,
              const std::string& typed) {
    time.node.reset();
    std::string error;
    try {
        const stage::TimeMap map = stage::parse_time_map(typed, "", "");
        error = error_of(map, clip);
        if (error.empty()) {
            set(context, node, {.time = map});
            return;
        }
    } catch (const InputError& problem) {
        error = problem.what();
    }
    // Removes the location from the message: there is no file, and the message itself names the operator.
    error.erase(0, error.find_first_not_of(": "));
    if (const size_t end = error.find(": "); error.starts_with('/') && end != std::string::npos)
        error.erase(0, end + 2);
    time = {node, context.editor.id(), typed, error};
}

// Each button tries another time map. An error is displayed as if the map had been typed.
void time_buttons(Context& context, FieldGroup& group, PropertyFields::Time& time, uint32_t node,
                  const stage::StageClip* clip, const stage::TimeMap& map) {
    const auto button = [&](const char* name, const char* tooltip) {
        const bool pressed = ImGui::Button(name);
        group.report_last(name);
        explain(tooltip);
        ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
        return pressed;
    };
    const auto append = [&](stage::TimeOperator added) {
        stage::TimeMap more = map;
        more.push_back(added);
        try_time(context, time, node, clip, stage::text_of(more));
    };
    group.label("");
    if (button("loop", "Again and again")) append({.verb = stage::TimeVerb::kLoop, .has_part = false});
    if (button("to and fro", "Forwards and backwards, again and again"))
        append({.verb = stage::TimeVerb::kPingPong, .has_part = false});
    if (button("plain", "As it was filmed, once")) try_time(context, time, node, clip, "");
    ImGui::NewLine();
}

void time_fields(Context& context, FieldGroup& group, PropertyFields::Time& time, uint32_t node,
                 const stage::TimeMap& map) {
    const stage::StageClip* const clip = clip_on(context, node);
    const bool wrong = time.node == node && time.id == context.editor.id();
    std::string text = wrong ? time.typed : stage::text_of(map);
    if (group.text("time", text)) try_time(context, time, node, clip, text);
    explain("How stage time becomes the clip's, step by step: offset:2s, speed:0.5, clip:1s:3s, reverse, loop, …");
    if (wrong) {
        ImGui::PushStyleColor(ImGuiCol_Text, ui::kError);
        ImGui::TextWrapped(ICON_WARNING " %s", time.error.c_str());
        ImGui::PopStyleColor();
        group.report_last("time error");
    }
    time_buttons(context, group, time, node, clip, map);
}

}  // namespace

void performer_fields(Context& context, FieldGroup& group, PropertyFields::Time& time, uint32_t node) {
    const auto settings = edit::performer_on(context.editor.file(), node);
    if (!settings) return;
    headline("Performer");
    clip_lines(clip_on(context, node), group, *settings);
    time_fields(context, group, time, node, settings->time);
    double opacity = settings->opacity;
    if (group.slider("opacity", opacity, 0, 1)) drag(context, node, {.opacity = opacity});
    double spin = settings->spin_deg_per_s;
    if (group.number("spin", spin, {-3600, 3600, 0.5, "%.1f°/s"})) drag(context, node, {.spin_deg_per_s = spin});
    bool casts = settings->casts_shadow, receives = settings->receives_shadow;
    if (group.toggle("casts shadow", casts)) set(context, node, {.casts_shadow = casts});
    if (group.toggle("shadows on it", receives)) set(context, node, {.receives_shadow = receives});
}

}  // namespace neuvv::viewer
