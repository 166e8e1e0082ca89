#include "stage/sound/heard_peaks.h"

#include <algorithm>
#include <cmath>

#include "stage/sound/heard.h"

namespace neuvv::stage {

namespace {

using ClipParts = std::vector<ClipPart>;

void add_part(ClipParts& parts, double begin, double end) {
    if (begin < end) parts.push_back({begin, end});
}

// Sorts the parts and unites those that overlap. Each operator then adds at most one part: parts that a loop or a
// ping-pong cuts all end where it turns, and are united there.
void unite(ClipParts& parts) {
    if (parts.size() < 2) return;
    std::sort(parts.begin(), parts.end(), [](const ClipPart& a, const ClipPart& b) { return a.begin < b.begin; });
    size_t last = 0;
    for (size_t i = 1; i < parts.size(); ++i) {
        if (parts[i].begin <= parts[last].end)
            parts[last].end = std::max(parts[last].end, parts[i].end);
        else
            parts[++last] = parts[i];
    }
    parts.resize(last + 1);
}

void add_looped(ClipParts& parts, const ClipPart& part, double from, double whole) {
    const double begin = std::fmod(part.begin, whole), end = begin + (part.end - part.begin);
    if (part.end - part.begin >= whole) return add_part(parts, from, from + whole);
    add_part(parts, from + begin, from + std::min(end, whole));
    add_part(parts, from, from + end - whole);
}

void add_ping_ponged(ClipParts& parts, const ClipPart& part, double from, double there) {
    if (!(there > kFrameTolerance)) return;  // it stands still
    if (part.end - part.begin >= 2 * there) return add_part(parts, from, from + there);
    const double begin = std::fmod(part.begin, 2 * there), end = begin + (part.end - part.begin);
    for (int way = 0; way < 4; ++way) {  // there, back, and again: it ends before four times as far
        const double low = std::max(begin - way * there, 0.0), high = std::min(end - way * there, there);
        if (way % 2 == 0)
            add_part(parts, from + low, from + high);
        else
            add_part(parts, from + there - high, from + there - low);
    }
}

// Adds what the operator shows of the clip before it while the clip after it goes through `part`. The table of
// time_map.h has the formulas.
void add_shown(ClipParts& parts, const Timeline::Step& step, const ClipPart& part) {
    switch (step.verb) {
        case TimeVerb::kOffset:
            return add_part(parts, part.begin - step.a, part.end - step.a);
        case TimeVerb::kSpeed:
            return add_part(parts, part.begin * step.factor, part.end * step.factor);
        case TimeVerb::kPause:
            add_part(parts, part.begin, std::min(part.end, step.a));
            return add_part(parts, std::max(part.begin - step.b, step.a), part.end - step.b);
        case TimeVerb::kFreeze:
            return;
        case TimeVerb::kClip:
            return add_part(parts, step.a + part.begin, step.a + part.end);
        case TimeVerb::kReverse:
            return add_part(parts, step.length - step.frame - part.end, step.length - step.frame - part.begin);
        case TimeVerb::kJump:
            add_part(parts, part.begin, std::min(part.end, step.a));
            return add_part(parts, std::max(part.begin, step.a) - step.a + step.b, part.end - step.a + step.b);
        case TimeVerb::kLoop:
            return add_looped(parts, part, step.a, step.b - step.a);
        case TimeVerb::kPingPong:
            return add_ping_ponged(parts, part, step.a, step.b - step.a - step.frame);
        case TimeVerb::kHold:
            return add_part(parts, part.begin, part.end);
    }
}

// Leaves out what is before the beginning or after the end, where the clip stands still.
void keep_within(ClipParts& parts, double length) {
    for (ClipPart& part : parts) part = {std::max(part.begin, 0.0), std::min(part.end, length)};
    std::erase_if(parts, [](const ClipPart& part) { return !(part.begin < part.end); });
}

// How fast the clip plays wherever it does not stand still, as a factor.
double speed_of(const Timeline& timeline) {
    double speed = 1;
    for (const Timeline::Step& step : timeline.steps)
        if (step.verb == TimeVerb::kSpeed) speed *= step.factor;
    return speed;
}

// With memory for the parts of an operator that the caller keeps.
void heard_parts_with(const Timeline& timeline, double from_s, double to_s, ClipParts& parts, ClipParts& before) {
    parts.clear();
    add_part(parts, from_s * timeline.fps, to_s * timeline.fps);
    for (size_t i = timeline.steps.size(); i-- > 0 && !parts.empty();) {
        const Timeline::Step& step = timeline.steps[i];
        keep_within(parts, step.length_after);
        before.clear();
        for (const ClipPart& part : parts) add_shown(before, step, part);
        parts.swap(before);
        unite(parts);
    }
    keep_within(parts, timeline.frames);
}

}  // namespace

void heard_parts(const Timeline& timeline, double from_s, double to_s, std::vector<ClipPart>& parts) {
    ClipParts before;
    heard_parts_with(timeline, from_s, to_s, parts, before);
}

void heard_peaks(const media::SoundPeaks& peaks, const Timeline& timeline, double begin_s, double column_s,
                 std::span<float> columns) {
    std::fill(columns.begin(), columns.end(), 0.0f);
    const double speed = speed_of(timeline);
    if (speed < kLeastHeardSpeed || speed > kMostHeardSpeed) return;
    ClipParts parts, before;
    for (size_t i = 0; i < columns.size(); ++i) {
        const double from_s = begin_s + static_cast<double>(i) * column_s;
        heard_parts_with(timeline, from_s, begin_s + static_cast<double>(i + 1) * column_s, parts, before);
        for (const ClipPart& part : parts)
            columns[i] = std::max(columns[i], peaks.largest(part.begin / timeline.fps, part.end / timeline.fps));
    }
}

}  // namespace neuvv::stage
