// Inside of the timeline panel: its rows, each kind in a file of its own.
#pragma once

#include <imgui.h>

#include <optional>

#include "tools/viewer/context.h"
#include "tools/viewer/timeline/timeline_state.h"

namespace neuvv::viewer {

// The time under a pointer there: at an image's beginning, or the clock's where that is near.
double snapped_time(const Context& context, const TimelineView& view, double time_s);

// Whether the pointer has gone far enough from where its button went down; also in the frame in which it is let go,
// whose last piece of the way counts.
bool is_dragged(const Context& context);
// A button as high as a row, without a ground until it is `on`.
bool small_button(Context& context, const TimelineView& view, const std::string& name, const char* icon,
                  const char* tooltip, bool on = false, bool enabled = true);

// The time line: transport, ruler, camera path, a row of each performer.
void timeline_panel(Context& context, const Area& area, TimelineState& state);

void transport_row(Context& context);
void ruler_row(Context& context, const TimelineView& view);
// `drag`: of a key, while one is dragged.
void camera_row(Context& context, const TimelineView& view, std::optional<KeyDrag>& drag,
                const std::optional<stage::CameraPath>& path);
// `drag`: of any performer's bar, the last one.
void performer_row(Context& context, const TimelineView& view, BarDrag& drag, const edit::PerformerTrack& track);

// What lies over rows from `top` to `bottom`: outside of the loop's range it is dimmer; the clock's time is a line.
void draw_range_and_time(Context& context, const TimelineView& view, float top, float bottom);

// "1.25 s".
std::string text_of_time(double seconds);

}  // namespace neuvv::viewer
