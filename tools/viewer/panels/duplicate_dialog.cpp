// The dialog for copies of a node: how many, where they stand, how much later each begins.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>

#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/stage_tree.h"

namespace neuvv::viewer {

namespace {

constexpr const char* kTitle = "Duplicate";
constexpr const char* kPatterns[] = {"row", "ring", "fan"};
constexpr const char* kUnits[] = {"frames", "seconds"};

void pattern_fields(FieldGroup& group, edit::CopySettings& copies) {
    auto pattern = static_cast<size_t>(copies.pattern);
    if (group.choice("pattern", pattern, kPatterns)) copies.pattern = static_cast<edit::CopyPattern>(pattern);
    double count = copies.count;
    if (group.number("copies", count, {1, edit::kMaxCopies, 0.1, "%.0f"})) copies.count = static_cast<uint32_t>(count);
    const bool row = copies.pattern == edit::CopyPattern::kRow;
    group.number(row ? "apart" : "radius", copies.distance_m, {row ? -1e4 : 0.0, 1e4, 0.01, "%.2f m"});
    if (copies.pattern == edit::CopyPattern::kFan) group.number("arc", copies.arc_deg, {-360, 360, 0.5, "%.0f°"});
}

void time_fields(FieldGroup& group, edit::CopySettings& copies) {
    size_t unit = copies.stagger.frames ? 0 : 1;
    const bool frames = copies.stagger.frames;
    group.number("each later by", copies.stagger.value,
                 {-1e5, 1e5, frames ? 0.1 : 0.01, frames ? "%.0f frames" : "%.2f s"});
    if (group.choice("counted in", unit, kUnits)) copies.stagger.frames = unit == 0;
    group.number("each spins by", copies.spin_step, {-3600, 3600, 0.5, "%.0f°/s more"});
}

bool button(Context& context, const char* name, const char* report, float width) {
    const bool pressed = ImGui::Button(name, {width, 0});
    context.report.item(report);
    return pressed;
}

}  // namespace

void ask_duplicate(const Context& context, CopyQuestion& question, uint32_t node) {
    question.node = node;
    question.id = context.editor.id();
    question.ask = true;
}

void duplicate_dialog(Context& context, StageTree& tree) {
    CopyQuestion& question = tree.copies;
    if (std::exchange(question.ask, false)) ImGui::OpenPopup(kTitle);
    const ImVec2 centre = ImGui::GetMainViewport()->GetCenter();
    ImGui::SetNextWindowPos(centre, ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({context.ui(360), 0});
    if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings)) return;
    const auto row = row_of(tree.rows, question.node);
    // After an undo, or in another document, the number may mean another node.
    if (!row || question.id != context.editor.id()) {
        ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
        return;
    }
    const bool performer = tree.rows[*row].kind == NodeKind::kPerformer;
    edit::CopySettings settings = question.settings;
    {
        FieldGroup group(context, "duplicate");
        pattern_fields(group, settings);
        if (performer) {
            ImGui::Separator();
            time_fields(group, settings);
        }
    }
    question.settings = settings;
    if (!performer) {
        settings.stagger.value = 0;
        settings.spin_step = 0;
    }
    ImGui::Separator();
    ImGui::TextWrapped(
        "%s", fmt::format("{} more: {} in all with \"{}\"", settings.count, settings.count + 1, tree.rows[*row].title)
                  .c_str());
    const float width = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    const bool cancel = button(context, "Cancel", "duplicate/cancel", width);
    ImGui::SameLine();
    if (button(context, "Duplicate", "duplicate/do", width)) {
        context.editor.edit(
            [&](edit::Document& document) { return edit::duplicate_node(document.file, question.node, settings); });
        ImGui::CloseCurrentPopup();
    }
    if (cancel || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace neuvv::viewer
