// The timeline panel, and, private to it, its rows, each kind in a file of its own.
#pragma once

#include <imgui.h>

#include <optional>

#include "editor/waveforms.h"
#include "tools/viewer/context.h"
#include "tools/viewer/timeline/timeline_state.h"

namespace neuvv::viewer {

// Snaps a time to the beginning of the nearest frame, or to the clock's time where that is within some pixels.
double snapped_time(const Context& context, const TimelineView& view, double time_s);

// Whether the pointer has moved so far since the left button went down that this is a drag and not a click. It is still
// true in the frame in which the button is released, because that frame's motion counts, too.
bool is_dragged(const Context& context);
// A button as high as a row, without a background unless it is `on`. It is reported by `name`.
bool small_button(Context& context, const TimelineView& view, const std::string& name, const char* icon,
                  const char* tooltip, bool on = false, bool enabled = true);

// The timeline: the transport buttons, the ruler, the camera path, and a row for each performer.
void timeline_panel(Context& context, const Area& area, TimelineState& state, editor::Waveforms& waveforms);

void transport_row(Context& context);
void ruler_row(Context& context, const TimelineView& view);
// `drag` is set while a key is dragged. `path`: nullopt where the stage has none.
void camera_row(Context& context, const TimelineView& view, std::optional<KeyDrag>& drag,
                const std::optional<stage::CameraPath>& path);
// The row of one of the state's tracks.
void performer_row(Context& context, TimelineState& state, const editor::Waveforms& waveforms,
                   const edit::PerformerTrack& track);
// Draws the waveform of the performer's sound from `top` to `bottom`, where it is heard; nothing while it has not been
// read. It is fainter where the performer is muted.
void draw_waveform(Context& context, TimelineState& state, const editor::Waveforms& waveforms,
                   const edit::PerformerTrack& track, float top, float bottom);

// Draws over rows from `top` to `bottom`: what is outside the range of the loop becomes darker, and a line marks the
// clock's time.
void draw_range_and_time(Context& context, const TimelineView& view, float top, float bottom);

// "1.25 s".
std::string text_of_time(double seconds);

}  // namespace neuvv::viewer
