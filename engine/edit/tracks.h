// Performers on a time line: what plays when, read from the document itself (read.h), and edits of their time maps.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "edit/time_edit.h"
#include "stage/stage.h"

namespace neuvv::edit {

struct PerformerTrack {
    uint32_t node = 0;  // of the document
    std::string name;   // its name, or "node 3"
    std::filesystem::path clip;
    ClipRate rate;  // of the clip
    stage::TimeMap map;
    stage::Timeline timeline;
    TimeBar bar;  // when it plays: before and after, its first and its last image stand
};

// The performers of the default scene, by node. Those whose clip is not among `clips` (not read yet) are left out. What
// is expected of the document: read.h.
std::vector<PerformerTrack> performer_tracks(const stage::StageFile& file, const std::vector<stage::StageClip>& clips);

// An edit of one performer's map, as the document has it.
using TimeEdit = std::function<stage::TimeMap(const stage::TimeMap&)>;
std::string edit_time(stage::StageFile& file, uint32_t node, const TimeEdit& edit);

// All performers of the clip that `node` plays, in the order of the document, each later than the one before by so much
// that `node` itself is later by `by_s`: the first stays where it is, unless it is `node`.
std::string stagger_together(stage::StageFile& file, const std::vector<stage::StageClip>& clips, uint32_t node,
                             double by_s);

// Of all operators together: how many times as fast, whether backwards.
double speed_of(const stage::TimeMap& map);
bool is_reversed(const stage::TimeMap& map);

// Whether a map repeats, by its last operator that does, and the map that repeats in another way, or (kOnce) no more.
enum class Repeat { kOnce, kLoop, kPingPong };
Repeat repeat_of(const stage::TimeMap& map);
stage::TimeMap repeated(stage::TimeMap map, Repeat repeat);

// The image that is shown at this stage time stands from then on for so long; always.
stage::TimeMap paused_at(stage::TimeMap map, const ClipRate& clip, double stage_s, double seconds);
stage::TimeMap frozen_at(stage::TimeMap map, const ClipRate& clip, double stage_s);

}  // namespace neuvv::edit
