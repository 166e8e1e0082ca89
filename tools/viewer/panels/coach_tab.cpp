// The tab of coaching: where the trainee's motion comes from, how the clip plays, what is shown, and
// what is off.
#include <imgui.h>

#include <algorithm>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"

namespace neuvv::viewer {

namespace {

constexpr double kSpeeds[] = {1, 0.75, 0.5, 0.25};
constexpr const char* kSpeedNames[] = {"full", "three quarters", "half", "a quarter"};

void source_fields(Context& context, FieldGroup& fields, Coaching& coaching) {
    fields.text("motion from", coaching.address);
    explain(
        "vmc, vmc:PORT, vmc:HOST:PORT: the VMC protocol\nudp:PORT, udp:HOST:PORT: lines of JSON; -: the same from "
        "stdin\nor a recorded file");
    fields.label("");
    if (!coaching.is_running()) {
        if (text_button(context, "coach/begin", ICON_PLAY " Begin")) coaching.begin(context);
        explain("With the selected performer, or the first that has a skeleton");
    } else if (text_button(context, "coach/end", ICON_STOP " End")) {
        coaching.end(context);
    }
}

void play_fields(Context& context, FieldGroup& fields, Coaching& coaching) {
    coach::CoachSettings& settings = coaching.settings;
    auto mode = static_cast<size_t>(settings.mode);
    if (fields.choice("mode", mode, coach::kModeNames)) settings.mode = static_cast<coach::Mode>(mode);
    explain(
        "watch: nothing is compared\nfollow: the clip waits for the trainee\nperform: it does not, and there is a "
        "report");
    auto speed = static_cast<size_t>(std::ranges::find(kSpeeds, settings.speed) - kSpeeds);
    if (fields.choice("speed", speed, kSpeedNames)) settings.speed = kSpeeds[speed];
    fields.toggle("mirror image", settings.mirrored);
    explain("The trainee does with the left what the trainer does with the right");
    fields.toggle("ghost", settings.ghost);
    explain("The trainee's skeleton in the trainer");
    fields.toggle("arrows", settings.arrows);
    explain("To where joints should be");
    fields.label("");
    const bool runs = coaching.is_running();
    const bool mistaken = runs && coaching.session().coach().last_mistake_s();
    if (text_button(context, "coach/again", ICON_LOOP " Again", mistaken)) coaching.repeat_mistake(context);
    explain("Back to a second before the last mistake");
    ImGui::SameLine();
    if (text_button(context, "coach/show", ICON_EYE " Show me", runs && coaching.session().best_view().has_value()))
        coaching.show_best_view(context);
    explain("Look from where the mistake is seen best");
    fields.label("");
    if (text_button(context, "coach/report", ICON_FILE " Report",
                    runs && !coaching.session().coach().recorded().frames.empty()))
        coaching.write_report(context);
    explain("A page about the recorded performance, beside the stage");
}

// A row for each limb: whether it counts, and what is off.
void limb_rows(Context& context, FieldGroup& fields, Coaching& coaching) {
    const coach::Coach* coach = coaching.is_running() ? &coaching.session().coach() : nullptr;
    const coach::LimbValues red = coach ? coach->red() : coach::LimbValues{};
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        bool counts = coaching.settings.compare.counted[i];
        const ImVec4 mark = ImGui::ColorConvertU32ToFloat4(ui::kWarning);
        if (red[i] > 0.5) ImGui::PushStyleColor(ImGuiCol_Text, mark);
        if (fields.toggle(motion::kLimbNames[i], counts)) {
            coaching.settings.compare.counted[i] = counts;
            context.redraw();
        }
        if (red[i] > 0.5) ImGui::PopStyleColor();
        explain("Whether it is compared");
    }
}

}  // namespace

void coach_tab(Context& context, Coaching& coaching) {
    headline("Coach");
    FieldGroup fields(context, "coach");
    source_fields(context, fields, coaching);
    play_fields(context, fields, coaching);
    headline("What counts");
    limb_rows(context, fields, coaching);
    if (!coaching.is_running()) return;
    const coach::Coach& coach = coaching.session().coach();
    headline("Feedback");
    if (coach.feedback().score >= 0) ImGui::Text("score %.0f of 100", coach.feedback().score);
    for (const std::string& remark : coach.remarks()) ImGui::TextColored({1, 0.4f, 0.3f, 1}, "%s", remark.c_str());
    if (!coach.ghost() && coach.settings().mode != coach::Mode::kWatch)
        ImGui::TextWrapped("Nobody is seen by %s: %s.", coaching.session().source()->name().c_str(),
                           coaching.session().source()->advice().c_str());
}

}  // namespace neuvv::viewer
