// The axis of the timeline: stage time in seconds along a row of pixels, and the marks of its ruler.
#pragma once

#include <cstdint>
#include <string>

namespace neuvv::viewer {

struct TimeAxis {
    double left = 0, width = 1;  // pixels
    double begin_s = 0;          // at `left`; may be negative
    double s_per_px = 0.01;
    double s_at(double x) const { return begin_s + (x - left) * s_per_px; }
    double x_at(double s) const { return left + (s - begin_s) / s_per_px; }
    double end_s() const { return s_at(left + width); }
};

// The limits of an axis: it shows at most the time from 0 to `extent_s`, with a margin on both sides, and at least so
// little that a frame is kMaxFrameWidth margins wide.
struct TimeLimits {
    double extent_s = 1, fps = 25, margin_px = 8;
};
constexpr double kMaxFrameWidth = 10;  // in margins

// The axis that shows all the time up to the extent, which counts as at least one frame.
TimeAxis fitted(TimeAxis axis, const TimeLimits& limits);
// Each notch reduces the displayed time to four fifths; a negative one extends it to five fourths. The time at `x`
// stays there where the limits allow.
TimeAxis zoomed(TimeAxis axis, double x, double notches, const TimeLimits& limits);
// Moves every time by so many pixels to the right, as far as the limits allow.
TimeAxis scrolled(TimeAxis axis, double moved_px, const TimeLimits& limits);

// The marks of a ruler: labelled ones at whole multiples of `major_s`, and small ones that divide these into `parts`.
struct TimeMarks {
    double major_s = 1;
    int parts = 1;
    bool frames = false;  // labels are frame numbers; else times
};
// Marks for a scale, with labels at least `label_px` apart and small marks at least `mark_px`. Marks less than a second
// apart are at whole frames.
TimeMarks marks_for(double s_per_px, double fps, double label_px, double mark_px);
// The label of the mark at number · major_s, as "3 s", "1:05" or "31 f" (frame 31); empty left of 0.
std::string label_of(const TimeMarks& marks, int64_t number, double fps);

// The nearest time at which a frame begins.
double nearest_frame_time(double time_s, double fps);

}  // namespace neuvv::viewer
