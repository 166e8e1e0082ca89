// What the program is, its guide and its licence. The texts travel in the program.
#include <imgui.h>

#include <fmt/format.h>

#include <string_view>

#include "tools/ui/theme.h"
#include "tools/viewer/panels/panels.h"
#include "viewer_texts/guide.h"
#include "viewer_texts/licence.h"

namespace neuvv::viewer {

namespace {

constexpr const char* kLibraries =
    "Vulkan (volk), GLFW, Dear ImGui, GLM, OpenXR, tinygltf, FFmpeg, OpenEXR, OpenVDB, libpng, libjpeg, OpenCV, Ceres, "
    "Eigen, Boost, CLI11, fmt, nlohmann/json, libcurl, zstd, Roboto, Font Awesome.";

std::string_view text_of(std::span<const unsigned char> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Begins a window in the centre of the display, as large as `share` of it. ImGui::End() ends it.
bool begin_window(const Context& context, const char* name, bool& open, float share) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(context.ui(900), share * size.x), share * size.y}, ImGuiCond_Appearing);
    if (context.frame.escape) open = false;
    return ImGui::Begin(name, &open, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
}

// Lines of Markdown: headings in the accent's colour, what is indented as code is faint, all else wrapped. Only what is
// visible is laid out line by line by ImGui's own clipping.
void show_text(std::string_view text) {
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string line(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool heading = line.starts_with("#"), code = line.starts_with("    ");
        if (heading) ImGui::PushStyleColor(ImGuiCol_Text, ui::kAccent);
        if (code) ImGui::PushStyleColor(ImGuiCol_Text, ui::kGood);
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted(heading ? line.c_str() + line.find_first_not_of("# ") : line.c_str());
        ImGui::PopTextWrapPos();
        if (heading || code) ImGui::PopStyleColor();
    }
}

void text_window(const Context& context, const char* name, bool& open, std::string_view text) {
    if (!open) return;
    if (begin_window(context, name, open, 0.8f)) {
        ImGui::BeginChild("text");
        show_text(text);
        ImGui::EndChild();
    }
    context.report.item(std::string("window/") + name);
    ImGui::End();
}

void about_window(const Context& context, const gpu::Device& device, bool& open) {
    if (!open) return;
    if (begin_window(context, "About NeuVV", open, 0.5f)) {
        ImGui::TextUnformatted("NeuVV " NEUVV_VERSION);
        ImGui::TextWrapped("Neural volumetric videos: filmed with many cameras, played from anywhere.");
        ImGui::TextDisabled("Apache License 2.0");
        ImGui::Separator();
        ImGui::TextUnformatted(fmt::format("Device: {}, {}", device.summary().name, device.summary().driver).c_str());
        ImGui::Separator();
        ImGui::TextWrapped("It uses %s", kLibraries);
    }
    context.report.item("window/About NeuVV");
    ImGui::End();
}

}  // namespace

void about_panels(Context& context, const gpu::Device& device) {
    PanelLayout& panels = context.view.panels;
    about_window(context, device, panels.about);
    text_window(context, "Guide", panels.guide, text_of(viewer_texts::guide));
    text_window(context, "Licence", panels.licence, text_of(viewer_texts::licence));
}

}  // namespace neuvv::viewer
