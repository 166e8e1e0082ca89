// The panel's page of copies: rows, rings and fans of the selected performer, each copy later than the one before.
#include <fmt/format.h>

#include <cmath>

#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/arrange.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr double kMaxCount = 24, kMinDistance_m = 0.2, kMaxDistance_m = 10, kMaxStagger_s = 2, kMaxArc_deg = 360;

void pattern_row(Rows& rows, edit::CopySettings& copies) {
    using enum edit::CopyPattern;
    const float one = column_width(3);
    const auto pattern = [&](const char* name, const char* label, edit::CopyPattern which) {
        if (rows.button(name, label, one, copies.pattern == which)) copies.pattern = which;
    };
    pattern("row", "Row", kRow);
    ImGui::SameLine();
    pattern("ring", "Ring", kRing);
    ImGui::SameLine();
    pattern("fan", "Fan", kFan);
}

}  // namespace

void copies_rows(Rows& rows) {
    edit::CopySettings& copies = rows.state.copies;
    const stage::StagePerformer* performer = selected_performer(rows.state);
    pattern_row(rows, copies);
    double count = copies.count;
    if (rows.slider("count", "%.0f more", count, 1, kMaxCount))
        copies.count = static_cast<uint32_t>(std::lround(count));
    const bool in_a_row = copies.pattern == edit::CopyPattern::kRow;
    rows.slider("distance", in_a_row ? "%.2f m apart" : "radius %.2f m", copies.distance_m, kMinDistance_m,
                kMaxDistance_m, ImGuiSliderFlags_Logarithmic);
    ImGui::BeginDisabled(copies.pattern != edit::CopyPattern::kFan);
    rows.slider("arc", "arc of %.0f°", copies.arc_deg, -kMaxArc_deg, kMaxArc_deg);
    ImGui::EndDisabled();
    rows.slider("stagger", "each %.2f s after the one before", copies.stagger.value, -kMaxStagger_s, kMaxStagger_s);
    ImGui::BeginDisabled(!performer);
    const std::string label = performer ? fmt::format(ICON_COPY " Make {} of {}", copies.count, performer->name)
                                        : "Select the performer that shall be copied";
    if (rows.button("make copies", label.c_str(), column_width(1))) make_copies(rows.state);
    ImGui::EndDisabled();
}

}  // namespace neuvv::headset
