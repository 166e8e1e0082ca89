// What the timeline keeps from frame to frame, the drag states of bars and keys included.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "edit/tracks.h"
#include "media/sound_peaks.h"
#include "stage/camera_path.h"
#include "stage/stage.h"
#include "tools/viewer/timeline/time_axis.h"

namespace neuvv::viewer {

// The layout of the rows: names at the left, time at the right. Pixels of the framebuffer.
struct TimelineView {
    TimeAxis axis;
    TimeLimits limits;
    float names_left = 0, names_width = 0, row_height = 0;
    float left() const { return static_cast<float>(axis.left); }
    float right() const { return static_cast<float>(axis.left + axis.width); }
    float x_at(double s) const { return static_cast<float>(axis.x_at(s)); }
};

enum class BarPart { kBody, kStart, kEnd };

// The drag state of a performer's bar.
struct BarDrag {
    uint32_t node = 0;
    BarPart part = BarPart::kBody;
    bool stagger = false;    // staggers the performers instead of moving this one (Alt)
    bool cancelled = false;  // by Escape
    double grabbed_s = 0;    // time under the pointer when it was grabbed
    double moved_s = 0;      // how far the bar or its edge has been moved
    edit::TimeBar before;    // when it was grabbed
};

// The drag state of a key of the camera path.
struct KeyDrag {
    size_t key = 0;                  // index in `before`, which the operation of a drag applies to
    bool cancelled = false;          // by Escape
    double grabbed_s = 0, to_s = 0;  // time under the pointer when it was grabbed; the key's time now
    stage::CameraPath before;        // when it was grabbed
};

// How loud a performer's sound is in each column of pixels, for the axis for which this was computed.
struct WaveformColumns {
    std::shared_ptr<const media::SoundPeaks> peaks;  // null: nothing has been computed yet
    TimeAxis axis;
    std::vector<float> amplitudes;  // 0 to 1, as the sound's file has them
};

struct TimelineState {
    TimelineView view;
    bool fits = true;     // the axis shows all the time, also when the stage becomes longer
    bool panned = false;  // the middle button drags the axis
    float scroll_y = 0;   // pixels by which the next frame scrolls the rows
    BarDrag bar_drag;     // the last one, of any performer
    std::optional<KeyDrag> key_drag;
    std::vector<edit::PerformerTrack> tracks;       // one per performer
    uint64_t tracks_of = 0;                         // the id of the document of the tracks
    std::map<uint32_t, WaveformColumns> waveforms;  // of the tracks that were displayed, by their nodes
    std::optional<uint32_t> scrolled_selected;      // the selected node that was scrolled to last
    std::shared_ptr<const stage::Stage> clips_of;   // the stage whose clips the tracks use
    std::optional<stage::CameraPath> path;          // nullopt: the stage has none
    std::vector<glm::dvec3> path_line;
    uint64_t path_of = 0;  // the id of the document of the path
};

}  // namespace neuvv::viewer
