#include "tools/viewer/timeline/time_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace neuvv::viewer {

namespace {

double max_s_per_px(const TimeAxis& axis, const TimeLimits& limits) {
    const double extent_s = std::max(limits.extent_s, 1 / limits.fps);
    return extent_s / std::max(1.0, axis.width - 2 * limits.margin_px);
}

TimeAxis clamped(TimeAxis axis, const TimeLimits& limits) {
    const double max = max_s_per_px(axis, limits);
    const double min = std::min(max, 1 / (limits.fps * kMaxFrameWidth * limits.margin_px));
    axis.s_per_px = std::clamp(axis.s_per_px, min, max);
    const double margin_s = limits.margin_px * axis.s_per_px;
    const double last_s = std::max(limits.extent_s, 1 / limits.fps) + margin_s - axis.width * axis.s_per_px;
    axis.begin_s = std::clamp(axis.begin_s, -margin_s, std::max(-margin_s, last_s));
    return axis;
}

}  // namespace

TimeAxis fitted(TimeAxis axis, const TimeLimits& limits) {
    axis.s_per_px = max_s_per_px(axis, limits);
    axis.begin_s = -limits.margin_px * axis.s_per_px;
    return axis;
}

TimeAxis zoomed(TimeAxis axis, double x, double notches, const TimeLimits& limits) {
    const double at_s = axis.s_at(x);
    axis.s_per_px *= std::pow(0.8, notches);
    axis.s_per_px = clamped(axis, limits).s_per_px;
    axis.begin_s = at_s - (x - axis.left) * axis.s_per_px;
    return clamped(axis, limits);
}

TimeAxis scrolled(TimeAxis axis, double moved_px, const TimeLimits& limits) {
    axis.begin_s -= moved_px * axis.s_per_px;
    return clamped(axis, limits);
}

TimeMarks marks_for(double s_per_px, double fps, double label_px, double mark_px) {
    const auto fits = [&](double spacing_s, double px) { return spacing_s >= px * s_per_px; };
    for (const int frames : {1, 2, 5, 10, 20, 50, 100})
        if (2 * frames <= fps && fits(frames / fps, label_px))
            return {frames / fps, fits(1 / fps, mark_px) ? frames : 1, true};
    double major_s = 1;
    for (const double spacing_s : {1., 2., 5., 10., 15., 30., 60., 120., 300., 600., 1800., 3600., 7200., 14400.}) {
        major_s = spacing_s;
        if (fits(major_s, label_px)) break;
    }
    const double frames = major_s * fps;
    if (frames == std::round(frames) && fits(1 / fps, mark_px)) return {major_s, static_cast<int>(frames)};
    for (const int parts : {10, 5, 3, 2}) {
        const double part_s = major_s / parts;
        const bool round = major_s == 1 || part_s == std::round(part_s);
        if (round && fits(part_s, mark_px)) return {major_s, parts};
    }
    return {major_s, 1};
}

std::string label_of(const TimeMarks& marks, int64_t number, double fps) {
    if (number < 0) return {};
    const double time_s = static_cast<double>(number) * marks.major_s;
    if (marks.frames) return fmt::format("{} f", std::llround(time_s * fps));
    const auto seconds = std::llround(time_s);
    return seconds < 60 ? fmt::format("{} s", seconds) : fmt::format("{}:{:02}", seconds / 60, seconds % 60);
}

double nearest_frame_time(double time_s, double fps) {
    return std::round(time_s * fps) / fps;
}

}  // namespace neuvv::viewer
