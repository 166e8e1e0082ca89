#include <fmt/format.h>

#include <cmath>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

constexpr double kSlowest = 0.1, kFastest = 4;

// Sets a speed from -kFastest to kFastest whose size is at least kSlowest.
void set_speed(editor::StageClock& clock, float speed) {
    const double size = std::clamp<double>(std::abs(speed), kSlowest, kFastest);
    clock.speed = speed < 0 ? -size : size;
}

void speed_field(Context& context) {
    constexpr auto kFlags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput;
    auto speed = static_cast<float>(context.view.clock.speed);
    ImGui::SetNextItemWidth(context.ui(54));
    if (ImGui::DragFloat("##speed", &speed, 0.01f, -kFastest, kFastest, "%.2f×", kFlags)) {
        // A drag below the slowest speed reverses the direction.
        const bool crossed = std::abs(speed) < kSlowest && std::abs(context.view.clock.speed) <= kSlowest + 1e-6 &&
                             (speed < context.view.clock.speed) == (context.view.clock.speed > 0);
        set_speed(context.view.clock, crossed ? static_cast<float>(-context.view.clock.speed) : speed);
    }
    context.report.item("timeline/speed");
    if (!ImGui::IsItemHovered()) return;
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) context.view.clock.speed = 1;
    if (!ImGui::IsItemActive())
        ImGui::SetTooltip("How fast it plays: drag; to the left of 0 backwards.\nDouble click: as fast as life.");
}

void time_text(const editor::StageClock& clock) {
    const float begin = ImGui::GetCursorPosX();
    const auto [time, of] = std::pair(
        fmt::format("{} · {}", text_of_time(clock.time_s()), clock.frame()),
        fmt::format("of {} · {} at {:.6g} fps", text_of_time(clock.duration_s()), clock.frames(), clock.fps()));
    const float widest =
        ImGui::CalcTextSize(fmt::format("{} · {}", text_of_time(clock.duration_s()), clock.frames()).c_str()).x;
    ImGui::TextUnformatted(time.c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("time · image, %s", of.c_str());
    const float next = begin + widest + ImGui::GetStyle().ItemSpacing.x;
    if (next + ImGui::CalcTextSize(of.c_str()).x > ImGui::GetWindowContentRegionMax().x) return;
    ImGui::SameLine(next);
    ImGui::TextDisabled("%s", of.c_str());
}

}  // namespace

std::string text_of_time(double seconds) {
    return fmt::format("{:.2f} s", seconds);
}

void transport_row(Context& context) {
    editor::StageClock& clock = context.view.clock;
    const float gap = context.ui(2);
    if (icon_button(context, "timeline/start", ICON_START, "To the start (Home)")) clock.scrub(clock.in_s());
    ImGui::SameLine(0, gap);
    if (icon_button(context, "timeline/step_back", ICON_STEP_BACK, "The image before (,)")) clock.step(-1);
    ImGui::SameLine(0, gap);
    const bool playing = clock.playing;
    if (icon_button(context, "timeline/play", playing ? ICON_PAUSE : ICON_PLAY,
                    playing ? "Pause (Space)" : "Play (Space)", playing))
        clock.play_or_pause();
    ImGui::SameLine(0, gap);
    if (icon_button(context, "timeline/step", ICON_STEP, "The next image (.)")) clock.step(1);
    ImGui::SameLine(0, gap);
    if (icon_button(context, "timeline/loop", ICON_LOOP, "Play again and again", clock.loops))
        clock.loops = !clock.loops;
    ImGui::SameLine(0, context.ui(8));
    speed_field(context);
    ImGui::SameLine(0, context.ui(8));
    ImGui::AlignTextToFramePadding();
    time_text(clock);
}

}  // namespace neuvv::viewer
