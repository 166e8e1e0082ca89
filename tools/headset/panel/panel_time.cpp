// The panel's page of a performer's time: when it begins, how fast and how often it plays, and whether it spins.
#include <cmath>

#include "edit/tracks.h"
#include "tools/headset/panel/panel_rows.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr double kShift_s = 0.5, kMaxOffset_s = 10, kMaxSpin_per_minute = 30, kDegPerS = 6;  // of a turn a minute
constexpr double kStill_per_minute = 0.5;                                                    // a slower spin is none

// What a row needs of the selected performer.
struct Timed {
    Rows& rows;
    const stage::StagePerformer& performer;
    edit::ClipRate clip;

    void edit(const edit::TimeEdit& edit) const {
        rows.state.editor.edit(
            [&](edit::Document& document) { return edit::edit_time(document.file, performer.node, edit); });
    }
    // A button that edits the time map. The editor reports where the map cannot be changed so.
    void button(const char* name, const char* label, float width, bool is_on, const edit::TimeEdit& edit) const {
        if (rows.button(name, label, width, is_on)) this->edit(edit);
    }
};

void repeat_row(const Timed& timed) {
    const stage::TimeMap& map = timed.performer.settings.time;
    const std::vector<float> widths = fitted_widths({"Once", ICON_LOOP " Loop", "To and fro", "Freeze"});
    const auto repeat = [&](const char* name, const char* label, float width, edit::Repeat which) {
        timed.button(name, label, width, edit::repeat_of(map) == which,
                     [which](const stage::TimeMap& before) { return edit::repeated(before, which); });
        ImGui::SameLine();
    };
    repeat("once", "Once", widths[0], edit::Repeat::kOnce);
    repeat("performer loop", ICON_LOOP " Loop", widths[1], edit::Repeat::kLoop);
    repeat("to and fro", "To and fro", widths[2], edit::Repeat::kPingPong);
    const bool frozen = edit::is_frozen(map);
    timed.button("freeze", "Freeze", widths[3], frozen,
                 [&timed, frozen, now_s = timed.rows.state.evaluated.time_s](const stage::TimeMap& before) {
                     return frozen ? edit::unfrozen(before) : edit::frozen_at(before, timed.clip, now_s);
                 });
}

void pace_row(const Timed& timed) {
    const float one = column_width(3);
    const stage::TimeMap& map = timed.performer.settings.time;
    const auto speed = [&](const char* name, const char* label, double factor) {
        timed.button(name, label, one, false,
                     [&](const stage::TimeMap& before) { return edit::sped(before, timed.clip, factor); });
        ImGui::SameLine();
    };
    speed("slower", "Half speed", 0.5);
    speed("faster", "Double speed", 2);
    timed.button("reverse", "Backwards", one, edit::is_reversed(map),
                 [&](const stage::TimeMap& before) { return edit::reversed(before, timed.clip); });
}

void shift_row(const Timed& timed) {
    const float one = column_width(2);
    const auto shift = [&](const char* name, const char* label, double by_s) {
        timed.button(name, label, one, false,
                     [&](const stage::TimeMap& before) { return edit::moved(before, timed.clip, by_s); });
    };
    shift("earlier", "0.5 s earlier", -kShift_s);
    ImGui::SameLine();
    shift("later", "0.5 s later", kShift_s);
}

void offset_row(const Timed& timed) {
    const double start_s = edit::bar_of(timed.performer.settings.time, timed.clip).start_s;
    const auto begin_at = [&](edit::Document& document, double to_s) {
        return edit::edit_time(document.file, timed.performer.node, [&](const stage::TimeMap& before) {
            return edit::moved(before, timed.clip, to_s - edit::bar_of(before, timed.clip).start_s);
        });
    };
    timed.rows.edit_slider("offset", "begins at %.2f s", start_s, -kMaxOffset_s, kMaxOffset_s, begin_at);
}

void spin_row(const Timed& timed) {
    timed.rows.edit_slider("spin", "spins %.1f times a minute", timed.performer.settings.spin_deg_per_s / kDegPerS,
                           -kMaxSpin_per_minute, kMaxSpin_per_minute, [&](edit::Document& document, double turns) {
                               if (std::abs(turns) < kStill_per_minute) turns = 0;
                               edit::PerformerEdit edit;
                               edit.spin_deg_per_s = turns * kDegPerS;
                               return edit::set_performer(document.file, timed.performer.node, edit);
                           });
}

}  // namespace

// Without a selected performer, the rows are grey and show those of one whose time nobody has edited.
void performer_time_rows(Rows& rows) {
    const stage::StagePerformer* performer = selected_performer(rows.state);
    edit::ClipRate clip;
    if (performer) {
        const stage::StageClip& of = rows.state.stage->clips[performer->clip];
        clip = {of.frames, of.fps};
    }
    performer_title(rows.state);
    ImGui::BeginDisabled(!performer);
    const stage::StagePerformer nobody;
    const Timed timed{rows, performer ? *performer : nobody, clip};
    repeat_row(timed);
    pace_row(timed);
    shift_row(timed);
    offset_row(timed);
    spin_row(timed);
    ImGui::EndDisabled();
}

}  // namespace neuvv::headset
