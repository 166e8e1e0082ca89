#include "tools/viewer/timeline_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "edit/operations.h"

namespace neuvv::viewer {

namespace {

using nlohmann::ordered_json;

const ordered_json* member(const ordered_json& object, const char* name) {
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

// By node: whether the default scene reaches it. A document without scenes shows all.
std::vector<bool> in_default_scene(const ordered_json& json) {
    const ordered_json& nodes = *member(json, "nodes");
    const ordered_json* scenes = member(json, "scenes");
    if (!scenes || scenes->empty()) return std::vector<bool>(nodes.size(), true);
    std::vector<bool> reached(nodes.size(), false);
    std::vector<size_t> waiting;
    const auto add = [&](const ordered_json* list) {
        if (list)
            for (const ordered_json& node : *list) waiting.push_back(node.get<size_t>());
    };
    add(member((*scenes)[json.value("scene", size_t{0})], "nodes"));
    while (!waiting.empty()) {
        const size_t node = waiting.back();
        waiting.pop_back();
        if (node >= nodes.size() || reached[node]) continue;
        reached[node] = true;
        add(member(nodes[node], "children"));
    }
    return reached;
}

std::optional<PerformerTrack> track_of(const stage::StageFile& file, uint32_t node, const ordered_json& performer,
                                       const std::vector<stage::StageClip>& clips) {
    const std::string place = fmt::format("/nodes/{}/extensions/{}", node, stage::kPerformerExtension);
    const stage::PerformerSettings settings = stage::performer_settings_of(performer, file.path.string(), place);
    PerformerTrack track;
    track.node = node;
    track.name = file.json["nodes"][node].value("name", std::string());
    if (track.name.empty()) track.name = fmt::format("node {}", node);
    track.clip = stage::absolute_path(stage::file_of_uri(file, settings.uri, place + "/uri"));
    const auto clip = std::find_if(clips.begin(), clips.end(),
                                   [&](const stage::StageClip& other) { return other.path == track.clip; });
    if (clip == clips.end()) return std::nullopt;
    track.map = settings.time;
    track.rate = {clip->frames, clip->fps};
    track.timeline = stage::timeline_of(track.map, clip->frames, clip->fps, file.path.string(), place + "/time");
    track.bar = edit::bar_of(track.map, track.rate);
    return track;
}

bool repeats(const stage::TimeOperator& op) {
    return op.verb == stage::TimeVerb::kLoop || op.verb == stage::TimeVerb::kPingPong;
}

// Where an operator goes that shall not care for when the performer begins: before the last offsets.
size_t before_start(const stage::TimeMap& map) {
    size_t at = map.size();
    while (at > 0 && (map[at - 1].verb == stage::TimeVerb::kOffset || map[at - 1].verb == stage::TimeVerb::kHold)) at--;
    return at;
}

// With an operator that says what is shown from a stage time on.
stage::TimeMap with_stop(stage::TimeMap map, const edit::ClipRate& clip, stage::TimeVerb verb, double stage_s,
                         double seconds) {
    const size_t at = before_start(map);
    double start_s = 0;
    for (size_t i = at; i < map.size(); i++)
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
    const ordered_json* nodes = member(file.json, "nodes");
    if (!nodes) return tracks;
    const std::vector<bool> shown = in_default_scene(file.json);
    for (uint32_t i = 0; i < nodes->size(); i++) {
        const ordered_json* extensions = member((*nodes)[i], "extensions");
        const ordered_json* performer = extensions ? member(*extensions, stage::kPerformerExtension) : nullptr;
        if (!performer || !shown[i]) continue;
        if (auto track = track_of(file, i, *performer, clips)) tracks.push_back(std::move(*track));
    }
    return tracks;
}

std::string edit_time(stage::StageFile& file, uint32_t node, const TimeEdit& edit) {
    const std::string place = fmt::format("/nodes/{}/extensions/{}", node, stage::kPerformerExtension);
    const ordered_json::json_pointer pointer(place);
    if (!file.json.contains(pointer)) throw InputError(file.path.string(), place, "is no performer");
    edit::PerformerEdit change;
    change.time = edit(stage::performer_settings_of(file.json.at(pointer), file.path.string(), place).time);
    return edit::set_performer(file, node, change);
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
    while (same[order].node != node) order++;
    const size_t first = order == 0 ? 1 : 0;
    const double step_s = by_s / static_cast<double>(order + first);
    for (size_t i = 0; i < same.size(); i++) {
        edit::PerformerEdit change;
        change.time = edit::moved(same[i].map, same[i].rate, static_cast<double>(i + first) * step_s);
        edit::set_performer(file, same[i].node, change);
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

stage::TimeMap held_at(stage::TimeMap map, const edit::ClipRate& clip, double stage_s, double seconds) {
    return with_stop(std::move(map), clip, stage::TimeVerb::kPause, stage_s, seconds);
}

stage::TimeMap frozen_at(stage::TimeMap map, const edit::ClipRate& clip, double stage_s) {
    return with_stop(std::move(map), clip, stage::TimeVerb::kFreeze, stage_s, 0);
}

}  // namespace neuvv::viewer
