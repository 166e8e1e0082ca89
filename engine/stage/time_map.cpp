#include "stage/time_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace neuvv::stage {

namespace {

// Stage times are clamped to ± this many frames, where doubles still resolve fractions of a frame.
constexpr double kMaxStageFrames = 1e15;

// `frame`, or the whole frame that is within kFrameTolerance of it.
double snapped(double frame) {
    const double whole = std::round(frame);
    return std::abs(frame - whole) <= kFrameTolerance ? whole : frame;
}

double in_frames(const ClipTime& time, double fps) {
    return snapped(time.frames ? time.value : time.value * fps);
}

// t mod period; a result less than kFrameTolerance below the period becomes 0.
double wrapped(double t, double period) {
    const double rest = std::fmod(t, period);
    return rest > period - kFrameTolerance ? 0 : rest;
}

// The number of frames from the first to the last frame of the part.
double ping_pong_length(const Timeline::Step& step) {
    return std::max(0.0, step.b - step.a - step.frame);
}

// What happens at the end of a part that is cut out or repeated: its last frame stands, or goes on as sound does.
enum class LastFrame { kStands, kGoesOn };

// The time of the clip before the operator that is shown at t after it; t is from 0 to the length after the operator.
double shown_by(const Timeline::Step& step, double t, LastFrame last) {
    const double whole = step.b - step.a;
    const double end = last == LastFrame::kStands ? std::max(0.0, whole - step.frame) : whole;  // of a part
    switch (step.verb) {
        case TimeVerb::kOffset:
            return t - step.a;
        case TimeVerb::kSpeed:
            return t * step.factor;
        case TimeVerb::kPause:
            return t <= step.a ? t : std::max(step.a, t - step.b);
        case TimeVerb::kFreeze:
            return step.a;
        case TimeVerb::kClip:
            return step.a + std::min(t, end);
        case TimeVerb::kReverse:
            return step.length - step.frame - t;
        case TimeVerb::kJump:
            return t < step.a - kFrameTolerance ? t : t - step.a + step.b;
        case TimeVerb::kLoop:
            return step.a + std::min(wrapped(t, whole), end);
        case TimeVerb::kPingPong: {
            const double length = ping_pong_length(step);
            if (length <= kFrameTolerance) return step.a;
            const double there_and_back = std::fmod(t, 2 * length);
            return step.a + std::min(there_and_back, 2 * length - there_and_back);
        }
        case TimeVerb::kHold:
            return t;
    }
    return t;
}

bool cuts_a_part(const TimeOperator& op) {
    return op.verb == TimeVerb::kClip ||
           ((op.verb == TimeVerb::kLoop || op.verb == TimeVerb::kPingPong) && op.has_part);
}

double length_after(const Timeline::Step& step) {
    switch (step.verb) {
        case TimeVerb::kOffset:
            return std::max(0.0, step.length + step.a);
        case TimeVerb::kSpeed:
            return step.length / step.factor;
        case TimeVerb::kPause:
            return step.length + step.b;
        case TimeVerb::kClip:
            return step.b - step.a;
        case TimeVerb::kJump:
            return std::max(0.0, step.length - (step.b - step.a));
        case TimeVerb::kLoop:
        case TimeVerb::kPingPong:
            return INFINITY;
        default:
            return step.length;
    }
}

}  // namespace

Timeline timeline_of(const TimeMap& map, uint32_t frames, double fps, const std::string& file,
                     const std::string& place) {
    Timeline timeline;
    timeline.frames = std::max(frames, 1u);
    timeline.fps = fps;
    double length = timeline.frames, frame = 1;
    for (size_t i = 0; i < map.size(); ++i) {
        const TimeOperator& op = map[i];
        Timeline::Step step{op.verb, in_frames(op.a, fps), in_frames(op.b, fps), op.factor, length, frame, 0};
        const bool loops = op.verb == TimeVerb::kLoop || op.verb == TimeVerb::kPingPong;
        if ((loops && !op.has_part) || op.verb == TimeVerb::kReverse) {
            if (!std::isfinite(length))
                throw InputError(file, fmt::format("{}/{}", place, i), "needs an end, and what is before it is endless",
                                 "put it before the loop, or give the loop a part: loop:0s:2s");
            step.a = 0;
            step.b = length;
        }
        if (cuts_a_part(op) && !(step.b - step.a >= kFrameTolerance))
            throw InputError(file, fmt::format("{}/{}", place, i), "plays an empty part of the clip",
                             "its second time is where the part ends");
        if (loops) step.b = std::max(step.b, step.a + kFrameTolerance * 10);
        if (op.verb == TimeVerb::kSpeed) frame /= op.factor;
        timeline.hold |= op.verb == TimeVerb::kHold;
        step.length_after = length = length_after(step);
        timeline.steps.push_back(step);
    }
    return timeline;
}

void expect_parts_within(const Timeline& timeline, const std::string& file, const std::string& place) {
    for (size_t i = 0; i < timeline.steps.size(); ++i) {
        const Timeline::Step& step = timeline.steps[i];
        const bool has_part =
            step.verb == TimeVerb::kClip || step.verb == TimeVerb::kLoop || step.verb == TimeVerb::kPingPong;
        if (!has_part || step.b <= step.length + 20 * kFrameTolerance) continue;
        throw InputError(
            file, fmt::format("{}/{}", place, i),
            fmt::format("ends at frame {:.6g}, but what it is of has {:.6g}", step.b, step.length),
            fmt::format("end it at {0:.6g}f; to hold the end, put pause:{0:.6g}f:1s before it", step.length));
    }
}

namespace {

// Frames of the clip's time, 0 to its end.
double place_in_clip(const Timeline& timeline, double stage_s, LastFrame last) {
    double t = snapped(std::clamp(stage_s * timeline.fps, -kMaxStageFrames, kMaxStageFrames));
    for (size_t i = timeline.steps.size(); i-- > 0;) {
        const Timeline::Step& step = timeline.steps[i];
        t = snapped(shown_by(step, std::clamp(t, 0.0, step.length_after), last));
    }
    return std::clamp(t, 0.0, static_cast<double>(timeline.frames));
}

}  // namespace

double clip_position(const Timeline& timeline, double stage_s) {
    return place_in_clip(timeline, stage_s, LastFrame::kGoesOn);
}

double frame_at(const Timeline& timeline, double stage_s) {
    const double t = std::min(place_in_clip(timeline, stage_s, LastFrame::kStands), timeline.frames - 1.0);
    return timeline.hold ? std::floor(t) : t;
}

double length_s(const Timeline& timeline) {
    return (timeline.steps.empty() ? timeline.frames : timeline.steps.back().length_after) / timeline.fps;
}

double period_s(const Timeline& timeline) {
    double period = 0;
    for (const Timeline::Step& step : timeline.steps) {
        if (step.verb == TimeVerb::kLoop) period = step.b - step.a;
        if (step.verb == TimeVerb::kPingPong) period = 2 * ping_pong_length(step);
        if (step.verb == TimeVerb::kSpeed) period /= step.factor;
        if (step.verb == TimeVerb::kFreeze || step.verb == TimeVerb::kClip) period = 0;
    }
    return period > kFrameTolerance ? period / timeline.fps : 0;
}

}  // namespace neuvv::stage
