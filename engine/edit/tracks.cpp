#include "edit/tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "edit/operations.h"

namespace neuvv::edit {

namespace {

std::string json_pointer_of(uint32_t node) {
    return fmt::format("/nodes/{}/extensions/{}", node, stage::kPerformerExtension);
}

std::optional<PerformerTrack> track_of(const stage::StageFile& file, uint32_t node,
                                       const stage::PerformerSettings& settings,
                                       const std::vector<stage::StageClip>& clips) {
    PerformerTrack track;
    track.node = node;
    track.name = node_title(file, node);
    track.clip = stage::file_or_address_of_uri(file, settings.uri, json_pointer_of(node) + "/uri");
    const auto clip = std::find_if(clips.begin(), clips.end(),
                                   [&](const stage::StageClip& other) { return other.path == track.clip; });
    if (clip == clips.end()) return std::nullopt;
    if (settings.sound) {
        track.sound = stage::file_or_address_of_uri(file, settings.sound->uri, json_pointer_of(node) + "/sound");
        track.gain_db = settings.sound->gain_db;
    }
    track.map = settings.time;
    track.rate = {clip->frames, clip->fps};
    track.timeline =
        stage::timeline_of(track.map, clip->frames, clip->fps, file.path.string(), json_pointer_of(node) + "/time");
    track.bar = bar_of(track.map, track.rate);
    return track;
}

bool repeats(const stage::TimeOperator& op) {
    return op.verb == stage::TimeVerb::kLoop || op.verb == stage::TimeVerb::kPingPong;
}

bool freezes(const stage::TimeOperator& op) {
    return op.verb == stage::TimeVerb::kFreeze;
}

// The index at which an operator is inserted whose effect must not depend on when the performer begins: before the last
// offsets.
size_t before_start(const stage::TimeMap& map) {
    size_t at = map.size();
    while (at > 0 && (map[at - 1].verb == stage::TimeVerb::kOffset || map[at - 1].verb == stage::TimeVerb::kHold)) --at;
    return at;
}

// Adds an operator that says what is displayed from a stage time on.
stage::TimeMap with_stop(stage::TimeMap map, const ClipRate& clip, stage::TimeVerb verb, double stage_s,
                         double seconds) {
    const size_t at = before_start(map);
    double start_s = 0;
    for (size_t i = at; i < map.size(); ++i)
        if (map[i].verb == stage::TimeVerb::kOffset)
            start_s += map[i].a.frames ? map[i].a.value / clip.fps : map[i].a.value;
    stage::TimeOperator op;
    op.verb = verb;
    op.a.value = std::max(0.0, stage_s - start_s);
    op.b.value = seconds;
    map.insert(map.begin() + static_cast<std::ptrdiff_t>(at), op);
    return map;
}

}  // namespace

std::vector<PerformerTrack> performer_tracks(const stage::StageFile& file, const std::vector<stage::StageClip>& clips) {
    std::vector<PerformerTrack> tracks;
    const std::vector<bool> in_scene = nodes_in_scene(file);
    for (uint32_t node = 0; node < in_scene.size(); ++node) {
        const auto settings = in_scene[node] ? performer_on(file, node) : std::nullopt;
        if (!settings) continue;
        if (auto track = track_of(file, node, *settings, clips)) tracks.push_back(std::move(*track));
    }
    return tracks;
}

std::string edit_time(stage::StageFile& file, uint32_t node, const TimeEdit& edit) {
    const auto settings = performer_on(file, node);
    if (!settings) throw InputError(file.path.string(), json_pointer_of(node), "is no performer");
    PerformerEdit change;
    change.time = edit(settings->time);
    return set_performer(file, node, change);
}

std::string stagger_together(stage::StageFile& file, const std::vector<stage::StageClip>& clips, uint32_t node,
                             double by_s) {
    std::vector<PerformerTrack> same = performer_tracks(file, clips);
    const auto own =
        std::find_if(same.begin(), same.end(), [&](const PerformerTrack& track) { return track.node == node; });
    if (own == same.end()) throw InputError(file.path.string(), fmt::format("node {}", node), "has no clip yet");
    const std::filesystem::path clip = own->clip;
    std::erase_if(same, [&](const PerformerTrack& track) { return track.clip != clip; });
    size_t order = 0;
    while (same[order].node != node) ++order;
    const size_t first = order == 0 ? 1 : 0;
    const double step_s = by_s / static_cast<double>(order + first);
    for (size_t i = 0; i < same.size(); ++i) {
        PerformerEdit change;
        change.time = moved(same[i].map, same[i].rate, static_cast<double>(i + first) * step_s);
        set_performer(file, same[i].node, change);
    }
    return fmt::format("{} performers, each {:.6g} s later than the one before", same.size(), step_s);
}

double speed_of(const stage::TimeMap& map) {
    double speed = 1;
    for (const stage::TimeOperator& op : map)
        if (op.verb == stage::TimeVerb::kSpeed) speed *= op.factor;
    return speed;
}

bool is_reversed(const stage::TimeMap& map) {
    return std::count_if(map.begin(), map.end(), [](const auto& op) { return op.verb == stage::TimeVerb::kReverse; }) %
               2 ==
           1;
}

Repeat repeat_of(const stage::TimeMap& map) {
    const auto last = std::find_if(map.rbegin(), map.rend(), repeats);
    if (last == map.rend()) return Repeat::kOnce;
    return last->verb == stage::TimeVerb::kLoop ? Repeat::kLoop : Repeat::kPingPong;
}

stage::TimeMap repeated(stage::TimeMap map, Repeat repeat) {
    const stage::TimeVerb verb = repeat == Repeat::kLoop ? stage::TimeVerb::kLoop : stage::TimeVerb::kPingPong;
    const auto last = std::find_if(map.rbegin(), map.rend(), repeats);
    if (last == map.rend()) {
        if (repeat == Repeat::kOnce) return map;
        stage::TimeOperator op;
        op.verb = verb;
        op.has_part = false;
        map.insert(map.begin() + static_cast<std::ptrdiff_t>(before_start(map)), op);
    } else if (repeat != Repeat::kOnce) {
        last->verb = verb;
    } else if (last->has_part) {
        last->verb = stage::TimeVerb::kClip;
    } else {
        map.erase(std::next(last).base());
    }
    return map;
}

stage::TimeMap paused_at(stage::TimeMap map, const ClipRate& clip, double stage_s, double seconds) {
    return with_stop(std::move(map), clip, stage::TimeVerb::kPause, stage_s, seconds);
}

stage::TimeMap frozen_at(stage::TimeMap map, const ClipRate& clip, double stage_s) {
    return with_stop(std::move(map), clip, stage::TimeVerb::kFreeze, stage_s, 0);
}

stage::TimeMap unfrozen(stage::TimeMap map) {
    std::erase_if(map, freezes);
    return map;
}

bool is_frozen(const stage::TimeMap& map) {
    return std::any_of(map.begin(), map.end(), freezes);
}

}  // namespace neuvv::edit
