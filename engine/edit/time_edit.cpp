#include "edit/time_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace neuvv::edit {

namespace {

constexpr const char* kPlace = "time map";
constexpr double kMinSpeed = 1e-3, kMaxSpeed = 1e3;

// A map as a bar. Times are frames at the clip's rate: `begin` and `end` of the shown part in the time of `inner`,
// `start` in the time of the stage.
struct Bar {
    stage::TimeMap inner;
    double length = 0;  // of `inner`; INFINITY where endless
    double frame = 1;   // the length of a clip's frame in it
    double begin = 0, end = 0;
    bool reverse = false;
    double speed = 1, start = 0;
    bool hold = false;

    double duration() const { return (end - begin) / speed; }
};

double in_frames(const stage::ClipTime& time, const ClipRate& clip) {
    return time.frames ? time.value : time.value * clip.fps;
}

stage::Timeline ready(const stage::TimeMap& map, const ClipRate& clip) {
    return stage::timeline_of(map, clip.frames, clip.fps, kPlace, "");
}

// Whether two offsets can be merged: both later or both earlier, or later and then earlier by no more. Earlier and then
// later cannot be merged, as the first cuts off what lies before the start.
bool merge(double first, double second) {
    return second == 0 || first == 0 || (first > 0) == (second > 0) || (first > 0 && first + second >= 0);
}

double take_start_offset(stage::TimeMap& inner, const ClipRate& clip) {
    double start = 0;
    while (!inner.empty() && inner.back().verb == stage::TimeVerb::kOffset) {
        const double by = in_frames(inner.back().a, clip);
        if (!merge(by, start)) break;
        start += by;
        inner.pop_back();
    }
    return start;
}

// Moves the last operator of `bar.inner` into the bar, where a bar can express it: the shown part, in the time after
// the operator, becomes the part in the time before it. Returns whether it did.
bool take_last(Bar& bar, const stage::Timeline::Step& step) {
    const double tolerance = 20 * stage::kFrameTolerance;
    if (step.verb == stage::TimeVerb::kSpeed) {
        bar.begin *= step.factor;
        bar.end *= step.factor;
        bar.speed *= step.factor;
    } else if (step.verb == stage::TimeVerb::kReverse && bar.end <= step.length + tolerance) {
        const double begin = bar.begin;
        bar.begin = std::max(0.0, step.length - bar.end);
        bar.end = step.length - begin;
        bar.reverse = !bar.reverse;
    } else if (step.verb == stage::TimeVerb::kClip && bar.end <= step.b - step.a + tolerance) {
        bar.begin += step.a;
        bar.end = std::min(bar.end + step.a, step.b);
    } else if (step.verb == stage::TimeVerb::kOffset && step.a <= 0) {
        bar.begin -= step.a;
        bar.end -= step.a;
    } else {
        return false;
    }
    return true;
}

double length_of(const stage::Timeline& timeline) {
    return timeline.steps.empty() ? timeline.frames : timeline.steps.back().length_after;
}

// Throws InputError where the given seconds are out of range.
double checked(double seconds) {
    if (!(std::abs(seconds) <= stage::kMaxClipTime))
        throw InputError(kPlace, "", fmt::format("{} is no time within {} s", seconds, stage::kMaxClipTime));
    return seconds;
}

Bar read_bar(const stage::TimeMap& map, const ClipRate& clip) {
    Bar bar;
    bar.inner = map;
    bar.hold =
        std::erase_if(bar.inner, [](const stage::TimeOperator& op) { return op.verb == stage::TimeVerb::kHold; }) > 0;
    ready(bar.inner, clip);  // throws where the map is not sound
    bar.start = take_start_offset(bar.inner, clip);
    const stage::Timeline timeline = ready(bar.inner, clip);
    bar.end = length_of(timeline);
    while (!bar.inner.empty() && take_last(bar, timeline.steps[bar.inner.size() - 1])) bar.inner.pop_back();
    const size_t kept = bar.inner.size();
    bar.length = kept < timeline.steps.size() ? timeline.steps[kept].length : length_of(timeline);
    bar.frame = kept < timeline.steps.size() ? timeline.steps[kept].frame : 1;
    if (kept == timeline.steps.size())
        for (const stage::Timeline::Step& step : timeline.steps)
            if (step.verb == stage::TimeVerb::kSpeed) bar.frame /= step.factor;
    return bar;
}

// Whole frames as such; other times as seconds, rounded to a billionth.
stage::ClipTime time_of(double frames, const ClipRate& clip) {
    constexpr double kSteps = 1e9;
    if (!(std::abs(frames / clip.fps) <= stage::kMaxClipTime))
        throw InputError(kPlace, "", fmt::format("reaches farther than {} s", stage::kMaxClipTime));
    const double whole = std::round(frames);
    if (std::abs(frames - whole) <= stage::kFrameTolerance && std::abs(whole) <= stage::kMaxClipTime)
        return {whole + 0.0, true};
    return {std::round(frames / clip.fps * kSteps) / kSteps, false};
}

stage::TimeOperator with_times(stage::TimeVerb verb, const stage::ClipTime& a, const stage::ClipTime& b = {}) {
    stage::TimeOperator op;
    op.verb = verb;
    op.a = a;
    op.b = b;
    return op;
}

void expect_room(const stage::TimeMap& map) {
    if (map.size() > stage::kMaxTimeOperators)
        throw InputError(kPlace, "", fmt::format("has more than {} operators", stage::kMaxTimeOperators));
}

stage::TimeMap write_bar(const Bar& bar, const ClipRate& clip) {
    stage::TimeMap map = bar.inner;
    const bool whole_end = std::abs(bar.end - bar.length) <= stage::kFrameTolerance || bar.end == bar.length;
    const auto add_offset = [&](double by) {
        if (!(std::abs(by) <= stage::kFrameTolerance))
            map.push_back(with_times(stage::TimeVerb::kOffset, time_of(by, clip)));
    };
    if (!std::isfinite(bar.end))
        add_offset(-bar.begin);
    else if (bar.begin > stage::kFrameTolerance || !whole_end)
        map.push_back(with_times(stage::TimeVerb::kClip, time_of(bar.begin, clip), time_of(bar.end, clip)));
    if (bar.reverse) map.push_back(with_times(stage::TimeVerb::kReverse, {}));
    if (!(std::abs(bar.speed - 1) <= 1e-12)) {
        if (!(bar.speed >= kMinSpeed && bar.speed <= kMaxSpeed))
            throw InputError(kPlace, "speed",
                             fmt::format("{:.6g} is not from {} to {}", bar.speed, kMinSpeed, kMaxSpeed));
        map.push_back(with_times(stage::TimeVerb::kSpeed, {}));
        map.back().factor = bar.speed;
    }
    add_offset(bar.start);
    if (bar.hold) map.push_back(with_times(stage::TimeVerb::kHold, {}));
    expect_room(map);
    ready(map, clip);
    return map;
}

// Seconds of the bar as frames of `inner`.
double inner_span(const Bar& bar, double seconds, const ClipRate& clip) {
    return seconds * clip.fps * bar.speed;
}

// Cuts `by` frames of `inner` off the bar's start; a negative number extends the bar.
void cut_start(Bar& bar, double by) {
    const double max = std::max(0.0, bar.end - bar.begin - bar.frame);
    if (bar.reverse) {
        by = std::clamp(by, std::min(0.0, bar.end - bar.length), max);
        bar.end -= by;
    } else {
        by = std::clamp(by, -bar.begin, max);
        bar.begin += by;
    }
    bar.start += by / bar.speed;
}

void cut_end(Bar& bar, double by) {
    const double max = std::max(0.0, bar.end - bar.begin - bar.frame);
    if (bar.reverse)
        bar.begin += std::clamp(by, -bar.begin, max);
    else
        bar.end -= std::clamp(by, std::min(0.0, bar.end - bar.length), max);
}

// loop:a:b is the same as clip:a:b,loop, and what comes before the loop is one round of it.
stage::TimeMap with_rounds_reversed(stage::TimeMap map, const ClipRate& clip) {
    const auto repeats = [](const stage::TimeOperator& op) {
        return op.verb == stage::TimeVerb::kLoop || op.verb == stage::TimeVerb::kPingPong;
    };
    auto loop = std::find_if(map.rbegin(), map.rend(), repeats).base() - 1;  // only these make a map endless
    if (std::exchange(loop->has_part, false)) {
        const stage::TimeOperator part =
            with_times(stage::TimeVerb::kClip, std::exchange(loop->a, {}), std::exchange(loop->b, {}));
        loop = map.insert(loop, part) + 1;
    }
    if (loop != map.begin() && (loop - 1)->verb == stage::TimeVerb::kReverse)
        map.erase(loop - 1);
    else
        map.insert(loop, with_times(stage::TimeVerb::kReverse, {}));
    expect_room(map);
    ready(map, clip);
    return map;
}

}  // namespace

TimeBar bar_of(const stage::TimeMap& map, const ClipRate& clip) {
    const Bar bar = read_bar(map, clip);
    return {bar.start / clip.fps, (bar.start + bar.duration()) / clip.fps};
}

stage::TimeMap moved(const stage::TimeMap& map, const ClipRate& clip, double by_s) {
    Bar bar = read_bar(map, clip);
    bar.start += checked(by_s) * clip.fps;
    return write_bar(bar, clip);
}

stage::TimeMap trimmed_start(const stage::TimeMap& map, const ClipRate& clip, double at_s) {
    Bar bar = read_bar(map, clip);
    cut_start(bar, inner_span(bar, checked(at_s) - bar.start / clip.fps, clip));
    return write_bar(bar, clip);
}

stage::TimeMap trimmed_end(const stage::TimeMap& map, const ClipRate& clip, double at_s) {
    Bar bar = read_bar(map, clip);
    if (std::isfinite(bar.end)) {
        cut_end(bar, inner_span(bar, (bar.start + bar.duration()) / clip.fps - checked(at_s), clip));
    } else {
        const double end = bar.begin + inner_span(bar, checked(at_s) - bar.start / clip.fps, clip);
        bar.end = std::max(end, bar.begin + bar.frame);
    }
    return write_bar(bar, clip);
}

stage::TimeMap reversed(const stage::TimeMap& map, const ClipRate& clip) {
    Bar bar = read_bar(map, clip);
    if (!std::isfinite(bar.end)) return with_rounds_reversed(map, clip);
    bar.reverse = !bar.reverse;
    return write_bar(bar, clip);
}

stage::TimeMap sped(const stage::TimeMap& map, const ClipRate& clip, double factor) {
    Bar bar = read_bar(map, clip);
    bar.speed *= factor;
    return write_bar(bar, clip);
}

stage::ClipTime stagger_offset(const stage::Timeline& timeline, const stage::ClipTime& by) {
    const bool waits = std::any_of(timeline.steps.begin(), timeline.steps.end(), [](const stage::Timeline::Step& step) {
        return step.verb == stage::TimeVerb::kOffset && step.a > 0;
    });
    if (waits) return by;
    const double period = stage::period_s(timeline) * (by.frames ? timeline.fps : 1);
    if (period == 0) return by;
    constexpr double kSteps = 1e9;  // per frame or second: the precision of the text
    double ahead = std::fmod(-by.value, period);
    if (ahead < 0) ahead += period;
    ahead = std::round(ahead * kSteps) / kSteps;
    return {ahead >= period ? 0 : -ahead, by.frames};
}

stage::TimeMap staggered(const stage::TimeMap& map, const ClipRate& clip, const stage::ClipTime& by) {
    return moved(map, clip, in_frames(stagger_offset(ready(map, clip), by), clip) / clip.fps);
}

}  // namespace neuvv::edit
