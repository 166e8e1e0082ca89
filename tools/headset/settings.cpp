#include "tools/headset/settings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace neuvv::headset {

namespace {

using nlohmann::ordered_json;

void read_comfort(editor::PreferenceReader& reader, const ordered_json& json, Comfort& comfort) {
    const std::string at = "comfort.";
    reader.boolean(json, at, "smoothWalk", comfort.smooth_walk);
    reader.boolean(json, at, "smoothTurn", comfort.smooth_turn);
    reader.number(json, at, "snap_deg", 5.0, 180.0, comfort.snap_deg);
    reader.number(json, at, "turn_deg_per_s", 10.0, 360.0, comfort.turn_deg_per_s);
    reader.number(json, at, "walk_m_per_s", 0.1, 10.0, comfort.walk_m_per_s);
    reader.boolean(json, at, "vignette", comfort.vignette);
    reader.number(json, at, "raised_m", kLowest_m, kHighest_m, comfort.raised_m);
}

// Reads a member that has one of two values. Returns whether it is the second one.
bool read_choice(editor::PreferenceReader& reader, const ordered_json& json, const char* name,
                 std::array<const char*, 2> values, bool before) {
    const ordered_json* member = editor::PreferenceReader::find(json, name);
    std::string value;
    const std::string at = std::string("brush.") + name;
    if (!member || !reader.text(*member, at, value)) return before;
    if (value != values[0] && value != values[1]) {
        reader.wrong.push_back(at);
        return before;
    }
    return value == values[1];
}

void read_brush(editor::PreferenceReader& reader, const ordered_json& json, HandBrush& brush) {
    const std::string at = "brush.";
    const bool is_box = read_choice(reader, json, "tip", {"ball", "box"}, brush.tip == HandBrush::Tip::kBox);
    brush.tip = is_box ? HandBrush::Tip::kBox : HandBrush::Tip::kBall;
    const bool erases = read_choice(reader, json, "does", {"paint", "erase"}, brush.mode == HandBrush::Mode::kErase);
    brush.mode = erases ? HandBrush::Mode::kErase : HandBrush::Mode::kPaint;
    reader.number(json, at, "radius_m", kMinBrush_m, kMaxBrush_m, brush.radius_m);
    reader.number(json, at, "opacity", kMinBrushOpacity, 1.0, brush.opacity);
    reader.boolean(json, at, "wholeClip", brush.whole_clip);
    reader.boolean(json, at, "byRay", brush.by_ray);
    const ordered_json& colour = reader.object(json, "colour");
    reader.number(colour, "brush.colour.", "red", 0.0f, 1.0f, brush.colour.r);
    reader.number(colour, "brush.colour.", "green", 0.0f, 1.0f, brush.colour.g);
    reader.number(colour, "brush.colour.", "blue", 0.0f, 1.0f, brush.colour.b);
}

// Rounded to four decimals, as people write numbers: 0.3, not 0.30000001192092896.
double rounded(double value) {
    return std::round(value * 1e4) / 1e4;
}

void write_comfort(ordered_json& json, const Comfort& comfort) {
    json["smoothWalk"] = comfort.smooth_walk;
    json["smoothTurn"] = comfort.smooth_turn;
    json["snap_deg"] = comfort.snap_deg;
    json["turn_deg_per_s"] = comfort.turn_deg_per_s;
    json["walk_m_per_s"] = comfort.walk_m_per_s;
    json["vignette"] = comfort.vignette;
    json["raised_m"] = rounded(comfort.raised_m);
}

void write_brush(ordered_json& json, const HandBrush& brush) {
    json["tip"] = brush.tip == HandBrush::Tip::kBox ? "box" : "ball";
    json["does"] = brush.mode == HandBrush::Mode::kErase ? "erase" : "paint";
    json["radius_m"] = rounded(brush.radius_m);
    ordered_json& colour = editor::object_in(json, "colour");
    colour["red"] = rounded(brush.colour.r);
    colour["green"] = rounded(brush.colour.g);
    colour["blue"] = rounded(brush.colour.b);
    json["opacity"] = rounded(brush.opacity);
    json["wholeClip"] = brush.whole_clip;
    json["byRay"] = brush.by_ray;
}

}  // namespace

void HeadsetSettings::load(HeadsetState& state, PerformerGrabSettings& grab) {
    if (path_.empty()) return;
    editor::PreferenceFile file = editor::load_preference_file(path_);
    editor::PreferenceReader reader;
    read_comfort(reader, reader.object(file.document, "comfort"), state.comfort);
    read_brush(reader, reader.object(file.document, "brush"), state.brush);
    reader.boolean(reader.object(file.document, "panel"), "panel.", "onWrist", state.panel_on_wrist);
    const ordered_json& grab_json = reader.object(file.document, "hold");
    reader.boolean(grab_json, "hold.", "upright", grab.upright);
    reader.boolean(grab_json, "hold.", "snapsToFloor", grab.snaps_to_floor);
    reader.boolean(grab_json, "hold.", "stepsHeading", grab.steps_heading);
    reader.boolean(grab_json, "hold.", "stepsPlace", grab.steps_place);
    const ordered_json& hands = reader.object(file.document, "hands");
    reader.boolean(hands, "hands.", "leftHanded", state.left_handed);
    reader.boolean(hands, "hands.", "hints", state.hints);
    reader.number(reader.object(file.document, "sound"), "sound.", "volume_percent", 0.0, kMostVolume_percent,
                  state.volume_percent);
    reader.boolean(reader.object(file.document, "panel"), "panel.", "frameTimes", state.shows_frame_times);
    const ordered_json& room = reader.object(file.document, "room");
    bool shown = false;
    reader.boolean(room, "room.", "shown", shown);
    if (const ordered_json* member = reader.find(room, "shown"); member && member->is_boolean())
        state.wants_room = shown;
    const std::string problem = file.message.empty() ? editor::wrong_members(path_, reader.wrong) : file.message;
    if (!problem.empty()) state.editor.notify(problem, true);
    saved_ = to_json(state, grab, file.document);
    document_ = std::move(file.document);
}

ordered_json HeadsetSettings::to_json(const HeadsetState& state, const PerformerGrabSettings& grab, ordered_json base) {
    write_comfort(editor::object_in(base, "comfort"), state.comfort);
    write_brush(editor::object_in(base, "brush"), state.brush);
    ordered_json& panel = editor::object_in(base, "panel");
    panel["onWrist"] = state.panel_on_wrist;
    panel["frameTimes"] = state.shows_frame_times;
    editor::object_in(base, "sound")["volume_percent"] = rounded(state.volume_percent);
    ordered_json& grab_json = editor::object_in(base, "hold");
    grab_json["upright"] = grab.upright;
    grab_json["snapsToFloor"] = grab.snaps_to_floor;
    grab_json["stepsHeading"] = grab.steps_heading;
    grab_json["stepsPlace"] = grab.steps_place;
    ordered_json& hands = editor::object_in(base, "hands");
    hands["leftHanded"] = state.left_handed;
    hands["hints"] = state.hints;
    if (state.wants_room) editor::object_in(base, "room")["shown"] = *state.wants_room;
    return base;
}

void HeadsetSettings::save(const HeadsetState& state, const PerformerGrabSettings& grab) {
    if (path_.empty()) return;
    ordered_json now = to_json(state, grab, document_);
    if (now == saved_) return;
    editor::save_preference_file(path_, now);
    saved_ = std::move(now);
}

}  // namespace neuvv::headset
