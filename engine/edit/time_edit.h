// Edits of a time map as one makes them on a time line, where a performer is a bar: it begins somewhere in stage time,
// shows some part of what there is, forwards or backwards, at some speed.
//
// A bar is the end of a map: what its other operators make, then as far as needed
//
//   clip:a:b (the part shown), reverse, speed:s, offset:x (where the bar begins, before the stage where x < 0)
//
// Each edit reads the bar from the map's end, whichever way that was written, changes it, and writes it anew: edits of
// many drags stay these few operators. So a start or an end that was trimmed can be pulled out again. `hold` goes last.
// All throw InputError as timeline_of, where a number leaves its range, and where the map would have more than
// kMaxTimeOperators.
#pragma once

#include "stage/time_map.h"

namespace neuvv::edit {

// What the map is of.
struct ClipRate {
    uint32_t frames = 1;
    double fps = 25;
};

// Seconds of stage time; end_s is INFINITY for what is endless.
struct TimeBar {
    double start_s = 0, end_s = 0;
};
TimeBar bar_of(const stage::TimeMap& map, const ClipRate& clip);

// The bar begins so much later, or earlier; what of it then lies before the stage comes back when it is moved back.
stage::TimeMap moved(const stage::TimeMap& map, const ClipRate& clip, double by_s);

// The bar begins, or ends, at this stage time; whatever it shows goes on being shown when it was. At least a frame is
// left, and no more is shown than there is: a bar that is pulled beyond ends where what it shows ends. Before and after
// a bar its first and its last frame stand; the last one, as a clip's, as long as a frame. What is endless may be given
// an end; its start is an offset into it, not a clip.
stage::TimeMap trimmed_start(const stage::TimeMap& map, const ClipRate& clip, double at_s);
stage::TimeMap trimmed_end(const stage::TimeMap& map, const ClipRate& clip, double at_s);

// The bar plays backwards where it stands, or forwards again; of what is endless, each of its rounds.
stage::TimeMap reversed(const stage::TimeMap& map, const ClipRate& clip);

// The bar plays so many times as fast, from where it begins.
stage::TimeMap sped(const stage::TimeMap& map, const ClipRate& clip, double factor);

// Later by `by`, as a copy among others: what never ends has begun before the stage (stagger_offset).
stage::TimeMap staggered(const stage::TimeMap& map, const ClipRate& clip, const stage::ClipTime& by);

// The offset of what is later by `by`. What never ends has begun before the stage, so that it runs from the start on:
// it is within a round of its period behind. What waits before it begins has a start to be later than.
stage::ClipTime stagger_offset(const stage::Timeline& timeline, const stage::ClipTime& by);

}  // namespace neuvv::edit
