// The timeline's axis: seconds of the stage along a row of pixels, and the marks of its ruler.
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

// What an axis may show: from 0 to `extent_s` with so many pixels free on both sides; at the closest an image is
// kMaxFrameWidth times `margin_px` wide.
struct TimeLimits {
    double extent_s = 1, fps = 25, margin_px = 8;
};
constexpr double kMaxFrameWidth = 10;

// All that there is. An extent of 0 is shown as one image.
TimeAxis fitted(TimeAxis axis, const TimeLimits& limits);
// Each notch shows four fifths of what was shown (negative: five quarters); what is at `x` stays there where the limits
// allow it.
TimeAxis zoomed(TimeAxis axis, double x, double notches, const TimeLimits& limits);
// What was at `x` is then at `x + moved_px`.
TimeAxis scrolled(TimeAxis axis, double moved_px, const TimeLimits& limits);

// Marks of a ruler: at whole multiples of `major_s` with a label, each of these divided into `parts`.
struct TimeMarks {
    double major_s = 1;
    int parts = 1;
    bool frames = false;  // labelled by the image's number, else by time
};
// So that labels are at least `label_px` apart, smaller marks at least `mark_px`. Below a second they are at whole
// frames.
TimeMarks marks_for(double s_per_px, double fps, double label_px, double mark_px);
// "3 s", "1:05", "31 f" of the mark at major_s · number; nothing left of 0.
std::string label_of(const TimeMarks& marks, int64_t number, double fps);

// The nearest time at which an image begins.
double nearest_frame_time(double time_s, double fps);

}  // namespace neuvv::viewer
