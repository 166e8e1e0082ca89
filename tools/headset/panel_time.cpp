// The panel's page of a performer's time: when it begins, how fast and how often it plays, and whether it spins.
#include <fmt/format.h>

#include <cmath>

#include "edit/tracks.h"
#include "tools/headset/panel_rows.h"
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

// The frame of its clip that is shown now.
float frame_of(const HeadsetState& state, const stage::StagePerformer& performer) {
    for (const stage::EvaluatedPerformer& at : state.evaluated.performers)
        if (&state.stage->performers[at.performer] == &performer) return at.frame;
    return 0;
}

void repeat_row(const Timed& timed) {
    const stage::TimeMap& map = timed.performer.settings.time;
    const float one = column_width(4);
    const auto repeat = [&](const char* name, const char* label, edit::Repeat which) {
        timed.button(name, label, one, edit::repeat_of(map) == which,
                     [which](const stage::TimeMap& before) { return edit::repeated(before, which); });
        ImGui::SameLine();
    };
    repeat("once", "Once", edit::Repeat::kOnce);
    repeat("performer loop", ICON_LOOP " Loop", edit::Repeat::kLoop);
    repeat("to and fro", "To and fro", edit::Repeat::kPingPong);
    const bool frozen = edit::is_frozen(map);
    timed.button("freeze", "Freeze", one, frozen,
                 [&timed, frozen, now_s = timed.rows.state.evaluated.time_s](const stage::TimeMap& before) {
                     return frozen ? edit::unfrozen(before) : edit::frozen_at(before, timed.clip, now_s);
                 });
}

void pace_row(const Timed& timed) {
    const float one = column_width(5);
    const auto change = [&](const char* name, const char* label, bool is_on, const auto& edit) {
        timed.button(name, label, one, is_on,
                     [&timed, &edit](const stage::TimeMap& before) { return edit(before, timed.clip); });
        ImGui::SameLine();
    };
    using stage::TimeMap, edit::ClipRate;
    const bool backwards = edit::is_reversed(timed.performer.settings.time);
    change("slower", "half speed", false,
           [](const TimeMap& map, const ClipRate& clip) { return edit::sped(map, clip, 0.5); });
    change("faster", "double speed", false,
           [](const TimeMap& map, const ClipRate& clip) { return edit::sped(map, clip, 2); });
    change("reverse", "backwards", backwards, edit::reversed);
    change("earlier", "0.5 s earlier", false,
           [](const TimeMap& map, const ClipRate& clip) { return edit::moved(map, clip, -kShift_s); });
    change("later", "0.5 s later", false,
           [](const TimeMap& map, const ClipRate& clip) { return edit::moved(map, clip, kShift_s); });
    ImGui::NewLine();
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

void performer_time_rows(Rows& rows) {
    const stage::StagePerformer* performer = selected_performer(rows.state);
    if (!performer) return ImGui::TextUnformatted("Select the performer whose time shall be edited.");
    const stage::StageClip& clip = rows.state.stage->clips[performer->clip];
    const Timed timed{rows, *performer, {clip.frames, clip.fps}};
    ImGui::Text("%s", performer->name.c_str());
    ImGui::SameLine();
    ImGui::TextDisabled("%s",
                        fmt::format("shows {:.2f} s of its clip", frame_of(rows.state, *performer) / clip.fps).c_str());
    repeat_row(timed);
    pace_row(timed);
    offset_row(timed);
    spin_row(timed);
}

}  // namespace neuvv::headset
