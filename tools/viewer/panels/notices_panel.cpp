#include <imgui.h>

#include <fmt/format.h>

#include <chrono>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/panels.h"
#include "voctree/files/clip.h"

namespace neuvv::viewer {

namespace {

constexpr double kNotice_s = 6;
constexpr size_t kMaxNotices = 4;
constexpr std::chrono::milliseconds kWait{500};  // of an image, until it is said

void line(unsigned colour, const char* icon, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextUnformatted(icon);
    ImGui::PopStyleColor();
    ImGui::SameLine();
    ImGui::TextWrapped("%s", text.c_str());
}

}  // namespace

void Notices::take(const Context& context) {
    const double now_s = context.frame.now_s;
    for (editor::Notice& notice : context.editor.take_notices()) {
        notice.until_s = now_s + kNotice_s;
        all_.push_back(std::move(notice));
        context.redraw();
    }
    std::erase_if(all_, [&](const editor::Notice& notice) {
        return notice.until_s < now_s && (context.editor.is_open() || !notice.error);
    });
    if (all_.size() > kMaxNotices) all_.erase(all_.begin(), all_.end() - static_cast<std::ptrdiff_t>(kMaxNotices));
}

void notices_panel(Context& context, std::span<const editor::Notice> notices) {
    const editor::RenderThreadState& rendered = context.frame.rendered;
    const auto jobs = context.jobs.under_way();
    const bool waits = rendered.waits_since && std::chrono::steady_clock::now() - *rendered.waits_since > kWait;
    if (rendered.waits_since && !waits) context.redraw(1);  // nothing may happen until then
    const bool nothing_open = !context.editor.is_open() && jobs.empty();
    if (notices.empty() && jobs.empty() && rendered.loading.empty() && rendered.problem.empty() && !waits &&
        !nothing_open)
        return;
    const Area& area = context.frame.image_area;
    ImGui::SetNextWindowPos({area.left + context.ui(12), area.top + area.height - context.ui(12)}, ImGuiCond_Always,
                            {0, 1});
    ImGui::SetNextWindowSize({std::min(context.ui(520), area.width - context.ui(24)), 0});
    ImGui::SetNextWindowBgAlpha(0.85f);
    ImGui::Begin("Notices", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs);
    if (nothing_open)
        line(ui::kAccent, ICON_OPEN,
             fmt::format(
                 "Drop a stage (.gltf, .glb), a clip ({}), splats (.ply), volumes (.vdb) or the folder of a data "
                 "set here, or choose File > Open.",
                 voctree::clip_endings_text()));
    for (const std::string& job : jobs) line(ui::kAccent, ICON_LOOP, job + "…");
    if (!rendered.loading.empty())
        line(ui::kAccent, ICON_LOOP,
             fmt::format("Reading {}: clip {} of {}…", rendered.loading, rendered.files_read + 1, rendered.files));
    if (waits) line(ui::kAccent, ICON_LOOP, "Waiting for what is shown at this time…");
    if (!rendered.problem.empty()) line(ui::kError, ICON_WARNING, rendered.problem);
    for (const editor::Notice& notice : notices)
        line(notice.error ? ui::kError : ui::kGood, notice.error ? ICON_WARNING : ICON_CHECK, notice.text);
    ImGui::End();
}

}  // namespace neuvv::viewer
