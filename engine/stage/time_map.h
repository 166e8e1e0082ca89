// From stage time to clip time: the paper's piecewise linear map, as a list of operators.
//
// Each operator edits the clip as the operators before it left it, as one edits a clip on a time line:
// `clip:1s:2s,loop` plays the second second for ever, `loop,offset:1s` loops the whole clip, starting a second late. A
// clip of N frames lasts N frames: the last one is shown as long as the others, whatever is before the start shows the
// start, and whatever is after the end shows the end. With t the time since the start, M the clip as it was before the
// operator, L its length and h a clip frame's length in it (a frame until a `speed`):
//
//   operator        what is shown at t                                            length after it
//   offset:x        M(t − x): starts x later, or x into it where x < 0            L + x
//   speed:s         M(s·t), 0.001 <= s <= 1000                                    L / s
//   pause:a:d       M(t) up to a, then M(a) for d, then M(t − d)                  L + d
//   freeze:a        M(a) always                                                   L
//   clip:a:b        M(a + t): the part from a up to b, b not included             b − a
//   reverse         M(L − h − t): the last frame first                            L
//   jump:a:b        M(t) before a, from a on M(t − a + b); b < a repeats          L − (b − a)
//   loop[:a:b]      M(a + t mod (b − a)): the part, or all of it, for ever        endless
//   ping-pong[:a:b] the part to its last frame and back to its first, for ever    endless
//   hold            ⌊M(t)⌋ of the clip, wherever it stands in the list: whole     L
//                   frames alone, backwards, too, the one that is not after M(t)
//
// Times are `2s`, seconds, or `3f`, frames of the clip at its own rate, or 0. A loop shows no mixture of its last and
// its first frame: the last one holds until the first comes. reverse, loop and ping-pong of what is endless need a
// part.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace neuvv::stage {

struct ClipTime {
    double value = 0;
    bool frames = false;  // else seconds
    bool operator==(const ClipTime&) const = default;
};

enum class TimeVerb { kOffset, kSpeed, kPause, kFreeze, kClip, kReverse, kJump, kLoop, kPingPong, kHold };

struct TimeOperator {
    TimeVerb verb = TimeVerb::kOffset;
    bool has_part = true;  // kLoop, kPingPong: `a` and `b` are given
    ClipTime a, b;         // in the order of the text form
    double factor = 1;     // kSpeed
    bool operator==(const TimeOperator&) const = default;
};

using TimeMap = std::vector<TimeOperator>;

constexpr size_t kMaxTimeOperators = 64;
constexpr double kMaxClipTime = 1e7;      // of an operator, in either unit
constexpr double kFrameTolerance = 1e-6;  // what is so near to a frame is that frame

// Text: "loop:0:2s,speed:0.5,offset:3f"; empty: the clip as it is. Throw InputError(file, place).
TimeMap parse_time_map(const std::string& text, const std::string& file, const std::string& place);
std::string text_of(const TimeMap& map);
ClipTime parse_clip_time(const std::string& text, const std::string& file, const std::string& place);
std::string text_of(const ClipTime& time);

// JSON, as NEUVV_performer has it: [{"operator": "loop", "from": "0s", "to": "2s"}, {"operator": "speed", "factor":
// 0.5}].
TimeMap time_map_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);
nlohmann::ordered_json json_of(const TimeMap& map);

// A map made ready for a clip: all in frames.
struct Timeline {
    struct Step {
        TimeVerb verb;
        double a, b;           // as in the table; loops have their part
        double factor;         // kSpeed
        double length, frame;  // L and h before the operator
        double length_after;   // INFINITY where endless
    };
    std::vector<Step> steps;
    uint32_t frames = 1;
    double fps = 25;
    bool hold = false;  // whole frames alone
};

// Throws InputError where an operator needs an end and its clip is endless, or a part is empty.
Timeline timeline_of(const TimeMap& map, uint32_t frames, double fps, const std::string& file,
                     const std::string& place);

// The frame of the clip, 0 to frames − 1, that is shown at a finite stage time; whole where it is within
// kFrameTolerance of a whole one.
double frame_at(const Timeline& timeline, double stage_s);

// Where the clip is then for who hears it: frames of its time, 0 to its end, which is `frames`. The last frame of what
// `clip` cuts out and `loop` repeats does not stand, but goes on to its end, and whole frames are not held. `reverse`
// and `ping-pong` turn at the beginning of the last frame, as images do.
double clip_position(const Timeline& timeline, double stage_s);

// Throws InputError where a part that is cut out or repeated reaches beyond the end of what it is of: the last frame
// would stand there, which nobody means. Files may have such parts.
void expect_parts_within(const Timeline& timeline, const std::string& file, const std::string& place);

// Seconds of stage time until its end; INFINITY where endless.
double length_s(const Timeline& timeline);

// Seconds of stage time after which an endless timeline shows the same again, sooner or later; 0: it has an end, or
// stands still.
double period_s(const Timeline& timeline);

}  // namespace neuvv::stage
