// Inside of the timeline panel: its rows, each kind in a file of its own.
#pragma once

#include <imgui.h>

#include <optional>

#include "tools/viewer/timeline/timeline_state.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

// The time under a pointer there: at an image's beginning, or the clock's where that is near.
double snapped_time(const Viewer& viewer, const TimelineView& view, double time_s);

// Whether the pointer has gone far enough from where its button went down; also in the frame in which it is let go,
// whose last piece of the way counts.
bool is_dragged(const Viewer& viewer);
// A button as high as a row, without a ground until it is `on`.
bool small_sign(Viewer& viewer, const TimelineView& view, const std::string& name, const char* sign,
                const char* explained, bool on = false, bool enabled = true);

void transport_row(Viewer& viewer);
void ruler_row(Viewer& viewer, const TimelineView& view);
void camera_row(Viewer& viewer, const TimelineView& view, const std::optional<stage::CameraPath>& path);
void performer_row(Viewer& viewer, const TimelineView& view, const edit::PerformerTrack& track);

// What lies over rows from `top` to `bottom`: outside of the loop's range it is dimmer; the clock's time is a line.
void draw_range_and_time(Viewer& viewer, const TimelineView& view, float top, float bottom);

// "1.25 s".
std::string text_of_time(double seconds);

}  // namespace neuvv::viewer
