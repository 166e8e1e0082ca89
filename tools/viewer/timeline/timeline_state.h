// What the time line remembers from frame to frame, and what of it is held by the mouse.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "edit/tracks.h"
#include "stage/camera_path.h"
#include "stage/stage.h"
#include "tools/viewer/timeline/time_axis.h"

namespace neuvv::viewer {

// Names left, time right; pixels of the framebuffer.
struct TimelineView {
    TimeAxis axis;
    TimeLimits limits;
    float names_left = 0, names_width = 0, row_height = 0;
    float left() const { return static_cast<float>(axis.left); }
    float right() const { return static_cast<float>(axis.left + axis.width); }
    float x_at(double s) const { return static_cast<float>(axis.x_at(s)); }
};

enum class BarPart { kBody, kStart, kEnd };

// A performer's bar: where it is held, and how it was.
struct BarDrag {
    uint32_t node = 0;
    BarPart part = BarPart::kBody;
    bool stagger = false, cancelled = false;
    double grabbed_s = 0, moved_s = 0;  // of the pointer; of the edge, so far
    edit::TimeBar before;
};

// A key of the camera path. Its number is that of before, as operations of a drag count.
struct KeyDrag {
    size_t key = 0;
    bool cancelled = false;
    double grabbed_s = 0, to_s = 0;
    stage::CameraPath before;
};

struct TimelineState {
    TimelineView view;
    bool fits = true;  // all is shown, and shall be when it becomes longer
    bool panned = false;
    float scroll_y = 0;  // of the rows, to be done in the next frame
    BarDrag bar_drag;    // the last one
    std::optional<KeyDrag> key_drag;
    std::vector<edit::PerformerTrack> tracks;
    uint64_t tracks_of = 0;                     // the document's id
    std::optional<uint32_t> scrolled_selected;  // already scrolled to
    std::shared_ptr<const stage::Stage> clips_of;
    std::optional<stage::CameraPath> path;
    std::vector<glm::dvec3> path_line;
    uint64_t path_of = 0;  // likewise
};

}  // namespace neuvv::viewer
