// The timeline's tracks: what plays when, read from the document itself, so that a track shows an edit in the frame
// after it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "edit/time_edit.h"
#include "stage/stage.h"

namespace neuvv {

struct PerformerTrack {
    uint32_t node = 0;  // of the document
    std::string name;   // its name, or "node 3"
    std::filesystem::path clip;
    ClipRate rate;  // of the clip
    TimeMap map;
    Timeline timeline;
    TimeBar bar;  // when it plays: before and after, its first and its last picture stand
};

// The performers of the default scene, by node. Those whose clip is not among `clips` (not read yet) are left out. The
// document is sound.
std::vector<PerformerTrack> performer_tracks(const StageFile& file, const std::vector<StageClip>& clips);

// An edit of one performer's map, as the document has it.
using TimeEdit = std::function<TimeMap(const TimeMap&)>;
std::string edit_time(StageFile& file, uint32_t node, const TimeEdit& edit);

// All performers of the clip that `node` plays, in the order of the document, each later than the one before by so much
// that `node` itself is later by `by_s`: the first stays where it is, unless it is `node`.
std::string stagger_together(StageFile& file, const std::vector<StageClip>& clips, uint32_t node, double by_s);

// Of all operators together: how many times as fast, whether backwards.
double speed_of(const TimeMap& map);
bool is_reversed(const TimeMap& map);

// Whether a map repeats, by its last operator that does, and the map that repeats in another way, or (kOnce) no more.
enum class Repeat { kOnce, kLoop, kPingPong };
Repeat repeat_of(const TimeMap& map);
TimeMap repeated(TimeMap map, Repeat repeat);

// The picture that is shown at this stage time stands from then on for so long; always.
TimeMap held_at(TimeMap map, const ClipRate& clip, double stage_s, double seconds);
TimeMap frozen_at(TimeMap map, const ClipRate& clip, double stage_s);

}  // namespace neuvv
