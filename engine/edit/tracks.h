// Performers on a time line: what plays when, read from the document (read.h), and edits of time maps by node.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "edit/time_edit.h"
#include "stage/stage.h"

namespace neuvv::edit {

struct PerformerTrack {
    uint32_t node = 0;  // index in the document
    std::string name;   // its name, or "node 3"
    std::filesystem::path clip;
    std::filesystem::path sound;  // absolute; empty: none
    double gain_db = 0;           // of the sound
    ClipRate rate;
    stage::TimeMap map;
    stage::Timeline timeline;
    TimeBar bar;  // when it plays; before and after, its first and its last frame are displayed
};

// The performers of the default scene, in order of nodes. Performers whose clip is not among `clips`, because it has
// not been read yet, are left out. read.h says what is expected of the document.
std::vector<PerformerTrack> performer_tracks(const stage::StageFile& file, const std::vector<stage::StageClip>& clips);

// Edits the time map of one performer. Throws InputError where the node is no performer.
using TimeEdit = std::function<stage::TimeMap(const stage::TimeMap&)>;
std::string edit_time(stage::StageFile& file, uint32_t node, const TimeEdit& edit);

// Staggers all performers that play the same clip as `node`: in the order of the document, each is moved later than the
// one before by the same step, such that `node` itself is moved by by_s seconds. The first one stays, unless it is
// `node`.
std::string stagger_together(stage::StageFile& file, const std::vector<stage::StageClip>& clips, uint32_t node,
                             double by_s);

// The speed of all operators together, as a factor; whether they play backwards.
double speed_of(const stage::TimeMap& map);
bool is_reversed(const stage::TimeMap& map);

// How a map repeats, by its last operator that does; and the map changed to repeat in another way, or not at all
// (kOnce).
enum class Repeat { kOnce, kLoop, kPingPong };
Repeat repeat_of(const stage::TimeMap& map);
stage::TimeMap repeated(stage::TimeMap map, Repeat repeat);

// paused_at: from this stage time on, the map stands still at the displayed frame for so many seconds. frozen_at: the
// map stands still for ever. unfrozen: it plays again, as if it had never stood still for ever.
stage::TimeMap paused_at(stage::TimeMap map, const ClipRate& clip, double stage_s, double seconds);
stage::TimeMap frozen_at(stage::TimeMap map, const ClipRate& clip, double stage_s);
stage::TimeMap unfrozen(stage::TimeMap map);
bool is_frozen(const stage::TimeMap& map);

}  // namespace neuvv::edit
