#include <imgui.h>

#include <fmt/format.h>

#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

void line(const std::string& text) {
    ImGui::TextUnformatted(text.c_str());
}

void statistics(const editor::DisplayedImage& displayed, const gpu::Device& device, const FrameMeter& meter) {
    line(device.summary().name);
    line(fmt::format("{:.1f} images a second, {:.1f} ms each", meter.images_per_second(), displayed.milliseconds));
    line(fmt::format("{:.2g} rays a pixel, {:.0f} ms from hand to image", displayed.scale * displayed.scale,
                     meter.latency_ms()));
    line(fmt::format("{:.2f} M live leaves and nodes, {:.0f} MiB", static_cast<double>(displayed.live_leaves) / 1e6,
                     static_cast<double>(device.buffer_bytes()) / 1048576));
}

}  // namespace

void statistics_panel(Context& context, const gpu::Device& device, const FrameMeter& meter) {
    const PanelLayout& panels = context.view.panels;
    const editor::DisplayedImage& displayed = context.frame.rendered.displayed;
    if ((!panels.statistics && !panels.pass_times) || displayed.view == 0) return;
    const Area& area = context.frame.image_area;
    ImGui::SetNextWindowPos({area.left + area.width - context.ui(12), area.top + context.ui(12)}, ImGuiCond_Always,
                            {1, 0});
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("Statistics", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs);
    if (panels.statistics) statistics(displayed, device, meter);
    if (panels.pass_times)
        for (const gpu::PassTime& pass : displayed.passes)
            line(fmt::format("{:8.2f} ms  {}", pass.milliseconds, pass.name));
    ImGui::End();
}

}  // namespace neuvv::viewer
