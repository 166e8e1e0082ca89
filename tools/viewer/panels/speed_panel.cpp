#include <imgui.h>

#include <fmt/format.h>

#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

void speed_panel(Context& context, const gpu::Device& device, const FrameMeter& meter) {
    const Area& area = context.frame.image_area;
    ImGui::SetNextWindowPos({area.left + area.width - context.ui(12), area.top + context.ui(12)}, ImGuiCond_Always,
                            {1, 0});
    ImGui::SetNextWindowBgAlpha(0.75f);
    ImGui::Begin("Speed", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs);
    const editor::DisplayedImage& displayed = context.frame.rendered.displayed;
    const std::string text = fmt::format(
        "{}\n{:.1f} images a second, {:.0f} ms from hand to image\n{:.1f} ms an image of {:.0f} % of its "
        "rays\n{:.2f} "
        "M live leaves and nodes\n{:.0f} MiB on the device",
        device.summary().name, meter.images_per_second(), meter.latency_ms(), displayed.milliseconds,
        100 * displayed.scale * displayed.scale, static_cast<double>(displayed.live_leaves) / 1e6,
        static_cast<double>(device.buffer_bytes()) / 1048576);
    ImGui::TextUnformatted(text.c_str());
    ImGui::Separator();
    for (const gpu::PassTime& pass : displayed.passes)
        ImGui::TextUnformatted(fmt::format("{:8.2f} ms  {}", pass.milliseconds, pass.name).c_str());
    ImGui::End();
}

}  // namespace neuvv::viewer
