// The dialog of a verb: its fields and its command line; while it runs, how far it is; then what it said.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "editor/open_file.h"
#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"
#include "tools/viewer/verbs/verb_task.h"
#include "voctree/files/clip.h"

namespace neuvv::viewer {

namespace {

using Kind = FormField::Kind;

bool verb_button(Context& context, const char* name, const char* text) {
    return text_button(context, name, text, true, context.ui(130));
}

void choice_field(FieldGroup& fields, const FormField& field, std::string& value) {
    std::vector<const char*> shown;
    for (const char* one : field.what) shown.push_back(*one ? one : "–");
    size_t selected = static_cast<size_t>(
        std::ranges::find_if(field.what, [&](const char* one) { return value == one; }) - field.what.begin());
    if (fields.choice(field.name, selected, shown)) value = field.what[selected];
}

void path_field(FieldGroup& fields, VerbTask& task, size_t index, Files& files) {
    const FormField& field = task.form().fields[index];
    const bool is_input = field.kind == Kind::kInput;
    const auto given = [&task, index, is_input](const std::string& path) {
        task.values[index] = path;
        if (is_input && !path.empty()) set_input(task.form(), path, task.values);
    };
    std::string typed = task.values[index];
    if (fields.text(field.name, typed)) given(typed);
    ImGui::PushID(field.name);
    fields.label("");
    if (ImGui::SmallButton(ICON_FOLDER "  Choose…")) {
        const std::vector<std::string> endings(field.what.begin(), field.what.end());
        files.ask_path(field.name, endings, !is_input, "",
                       [given](const std::filesystem::path& path) { given(path.string()); });
    }
    fields.report_last((std::string("choose ") + field.name).c_str());
    ImGui::PopID();
}

void form_fields(Context& context, VerbTask& task, Files& files) {
    FieldGroup fields(context, "verb");
    const VerbForm& form = task.form();
    for (size_t i = 0; i < form.fields.size(); ++i) {
        const FormField& field = form.fields[i];
        switch (field.kind) {
            case Kind::kInput:
            case Kind::kOutput:
                path_field(fields, task, i, files);
                break;
            case Kind::kChoice:
                choice_field(fields, field, task.values[i]);
                break;
            case Kind::kText:
                fields.text(field.name, task.values[i]);
                break;
        }
        if (*field.explanation) explain(field.explanation);
    }
    std::error_code error;
    const std::filesystem::path output = output_of(form, task.values);
    if (!output.empty() && std::filesystem::exists(output, error)) fields.toggle("replace", task.overwrite);
}

void start(Context& context, VerbTask& task) {
    try {
        task.start();
    } catch (const RuntimeFailure& failure) {
        context.editor.notify(failure.what(), true);
    }
    context.redraw();
}

void form_page(Context& context, VerbTask& task, Files& files) {
    ImGui::TextWrapped("%s", task.form().explanation);
    ImGui::Spacing();
    form_fields(context, task, files);
    ImGui::Spacing();
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("neuvv %s", command_text(task.arguments()).c_str());
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (verb_button(context, "verb/start", ICON_PLAY "  Start")) start(context, task);
    ImGui::SameLine();
    if (verb_button(context, "verb/close", "Close")) task.close();
}

void output_lines(const Context& context, const VerbTask& task) {
    ImGui::BeginChild("lines", {0, context.ui(150)}, true);
    for (const std::string& line : task.lines()) {
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted(line.c_str());
        ImGui::PopTextWrapPos();
    }
    if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
    ImGui::EndChild();
}

// The clip that the verb writes can be watched as soon as it is there.
void open_button(Context& context, VerbTask& task, Files& files) {
    const std::filesystem::path output = output_of(task.form(), task.values);
    std::error_code error;
    if (!voctree::has_clip_ending(output) || !std::filesystem::exists(output, error)) return;
    ImGui::SameLine();
    if (verb_button(context, "verb/watch", ICON_OPEN "  Watch")) files.open(output);
}

void running_page(Context& context, VerbTask& task, Files& files) {
    const double share = task.progress();
    const std::string percent = share < 0 ? "…" : fmt::format("{:.0f} %", 100 * share);
    ImGui::ProgressBar(static_cast<float>(std::max(0.0, share)), {-FLT_MIN, 0}, percent.c_str());
    context.report.item("verb/progress");
    ImGui::TextWrapped("%s", task.status().c_str());
    output_lines(context, task);
    if (verb_button(context, "verb/stop", ICON_STOP "  Stop")) task.stop();
    open_button(context, task, files);
}

void ended_page(Context& context, VerbTask& task, Files& files) {
    const bool good = task.code() == 0;
    ImGui::PushStyleColor(ImGuiCol_Text, good ? ui::kGood : ui::kError);
    ImGui::TextUnformatted(good ? ICON_CHECK "  It has ended." : ICON_WARNING "  It has failed.");
    ImGui::PopStyleColor();
    output_lines(context, task);
    if (verb_button(context, "verb/back", "Back")) task.back();
    ImGui::SameLine();
    if (verb_button(context, "verb/close", "Close")) return task.close();
    if (good) open_button(context, task, files);
    if (!good || std::string(task.form().verb) != "capture") return;
    ImGui::SameLine();
    if (verb_button(context, "verb/train", ICON_PLAY "  Train it…"))
        task.ask("train", output_of(task.form(), task.values));
}

}  // namespace

void verb_dialog(Context& context, VerbTask& task, Files& files) {
    if (task.tick()) context.redraw();
    if (!task.is_open()) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(context.ui(520), 0.9f * size.x), 0});
    const std::string title = std::string(task.form().title) + "###verb";
    if (ImGui::Begin(
            title.c_str(), nullptr,
            ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
        if (task.is_running())
            running_page(context, task, files);
        else if (task.code())
            ended_page(context, task, files);
        else
            form_page(context, task, files);
    }
    ImGui::End();
}

}  // namespace neuvv::viewer
