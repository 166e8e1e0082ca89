// The panel's page of coaching with a performer: how the clip plays, what is shown, what counts, and what is off.
#include <fmt/format.h>

#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/coaching.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr ImU32 kWrong = IM_COL32(200, 60, 45, 255), kRemark = IM_COL32(255, 102, 77, 255);
constexpr const char* kModeLabels[] = {"Watch", "Follow", "Perform"};
struct ClipSpeed {
    double speed;
    const char *name, *label;
};
constexpr ClipSpeed kClipSpeeds[] = {
    {1, "speed 1", "speed 1"}, {0.75, "speed 0.75", "0.75"}, {0.5, "speed 0.5", "0.5"}, {0.25, "speed 0.25", "0.25"}};

void session_row(Rows& rows) {
    Coaching& coaching = rows.coaching;
    const float one = column_width(4);
    if (!coaching.is_running()) {
        if (rows.button("begin coaching", ICON_PLAY " Begin", one)) coaching.begin(rows.state);
    } else if (rows.button("end coaching", ICON_STOP " End", one)) {
        coaching.end(rows.state);
    }
    for (size_t i = 0; i < std::size(kModeLabels); ++i) {
        const auto mode = static_cast<coach::Mode>(i);
        ImGui::SameLine();
        if (rows.button(coach::kModeNames[i], kModeLabels[i], one, coaching.settings.mode == mode))
            coaching.settings.mode = mode;
    }
}

void clip_speed_row(Rows& rows) {
    const float one = column_width(static_cast<int>(std::size(kClipSpeeds)));
    double& speed = rows.coaching.settings.speed;
    for (const ClipSpeed& each : kClipSpeeds) {
        if (&each != kClipSpeeds) ImGui::SameLine();
        if (rows.button(each.name, each.label, one, speed == each.speed)) speed = each.speed;
    }
}

void view_row(Rows& rows) {
    Coaching& coaching = rows.coaching;
    coach::CoachSettings& settings = coaching.settings;
    constexpr const char* kAgain = ICON_LOOP " Again";
    const std::vector<float> widths = fitted_widths({kAgain, "Show me", "Mirrored", "Ghost", "Arrows"});
    ImGui::BeginDisabled(!coaching.is_running() || !coaching.session().coach().last_mistake_s());
    if (rows.button("again", kAgain, widths[0])) coaching.repeat_mistake(rows.state);
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!coaching.session().best_view());
    if (rows.button("show me", "Show me", widths[1])) coaching.show_best_view();
    ImGui::EndDisabled();
    ImGui::SameLine();
    rows.toggle("mirror image", "Mirrored", widths[2], settings.mirrored);
    ImGui::SameLine();
    rows.toggle("ghost", "Ghost", widths[3], settings.ghost);
    ImGui::SameLine();
    rows.toggle("arrows", "Arrows", widths[4], settings.arrows);
}

// Which limbs count; those that are wrong are red.
void limb_row(Rows& rows) {
    const Coaching& coaching = rows.coaching;
    const coach::LimbValues red = coaching.is_running() ? coaching.session().coach().red() : coach::LimbValues{};
    constexpr size_t kInARow = 3;
    const float one = column_width(kInARow);
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        if (i % kInARow > 0) ImGui::SameLine();
        const bool counts = rows.coaching.settings.compare.counted[i], wrong = red[i] > 0.5;
        if (wrong) ImGui::PushStyleColor(ImGuiCol_Button, kWrong);
        if (rows.button(motion::kLimbNames[i], motion::kLimbNames[i], one, counts && !wrong))
            rows.coaching.settings.compare.counted[i] = !counts;
        if (wrong) ImGui::PopStyleColor();
    }
}

void feedback_text(const Coaching& coaching) {
    if (!coaching.is_running())
        return ImGui::TextWrapped(
            "Select a performer with a skeleton by the tool Arrange, or take the first one, and perform along with "
            "it.");
    const coach::Coach& coach = coaching.session().coach();
    ImGui::Text("%s", coaching.session().trainer_name().c_str());
    ImGui::SameLine();
    if (coach.settings().mode == coach::Mode::kWatch) return ImGui::TextDisabled("nothing is compared");
    if (!coach.ghost()) {
        const motion::PoseSource* const source = coaching.session().source();
        return ImGui::TextWrapped("nobody is seen: %s",
                                  source ? source->advice().c_str() : "hold the hands where the headset sees them");
    }
    if (coach.feedback().score < 0) return ImGui::TextDisabled("too little of the body was seen to be compared");
    ImGui::Text("%s", fmt::format("score {:.0f} of 100", coach.feedback().score).c_str());
    const std::string remarks = fmt::format("{}", fmt::join(coach.remarks(), ", "));
    ImGui::PushStyleColor(ImGuiCol_Text, kRemark);
    ImGui::TextWrapped("%s", remarks.c_str());
    ImGui::PopStyleColor();
}

}  // namespace

void coaching_rows(Rows& rows) {
    session_row(rows);
    clip_speed_row(rows);
    view_row(rows);
    limb_row(rows);
    feedback_text(rows.coaching);
}

}  // namespace neuvv::headset
