// Edits of a time map as one makes them on a time line, where a performer is a bar: it begins at some stage time and
// shows a part of its material, forwards or backwards, at some speed.
//
// A bar is the end of a time map. The map's other operators make the material, and these follow as far as they are
// needed:
//
//     clip:a:b (the part shown), reverse, speed:s, offset:x (where the bar begins; before the stage where x < 0)
//
// Each edit reads the bar from the end of the map, in whatever form that was written, changes it, and writes it again.
// So a map keeps these few operators after many drags, and what was trimmed from a start or an end can be brought back.
// `hold` is always the last operator. All functions throw InputError as timeline_of does, where a number is out of its
// range, and where the map would have more than kMaxTimeOperators.
#pragma once

#include "stage/time_map.h"

namespace neuvv::edit {

// The number of frames and the frame rate of the clip that a map is for.
struct ClipRate {
    uint32_t frames = 1;
    double fps = 25;
};

// The time of a bar in seconds of stage time; end_s is INFINITY where the map is endless.
struct TimeBar {
    double start_s = 0, end_s = 0;
};
TimeBar bar_of(const stage::TimeMap& map, const ClipRate& clip);

// Moves the bar later by by_s seconds, or earlier where that is negative. What then lies before the stage comes back
// when the bar is moved back.
stage::TimeMap moved(const stage::TimeMap& map, const ClipRate& clip, double by_s);

// Moves the start, or the end, of the bar to this stage time; what the bar shows stays at its time. At least one frame
// remains, and the bar ends where its material ends. Before a bar its first frame is displayed, and after it its last
// one; the last frame of a bar lasts as long as a frame, as that of a clip does. An endless map may be given an end;
// its start is trimmed by an offset, not by a clip operator.
stage::TimeMap trimmed_start(const stage::TimeMap& map, const ClipRate& clip, double at_s);
stage::TimeMap trimmed_end(const stage::TimeMap& map, const ClipRate& clip, double at_s);

// Plays the bar backwards at the same time, or forwards again; of an endless map, each round.
stage::TimeMap reversed(const stage::TimeMap& map, const ClipRate& clip);

// Multiplies the speed of the bar, which begins at the same time.
stage::TimeMap sped(const stage::TimeMap& map, const ClipRate& clip, double factor);

// Moves the bar later by `by`, as one of several copies: an endless map still runs from the start of the stage on
// (stagger_offset).
stage::TimeMap staggered(const stage::TimeMap& map, const ClipRate& clip, const stage::ClipTime& by);

// The offset that makes a map later by `by`. An endless map is shifted backwards, by less than a round of its period,
// so that it runs from the start of the stage on. A map that waits before it begins is simply later by `by`.
stage::ClipTime stagger_offset(const stage::Timeline& timeline, const stage::ClipTime& by);

}  // namespace neuvv::edit
