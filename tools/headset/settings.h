// The preferences of a headset's user, kept between runs as JSON in config_folder()/"headset.json".
//
//   {"comfort": {"smoothWalk": false, "smoothTurn": false, "snap_deg": 30, "turn_deg_per_s": 90, "walk_m_per_s": 1.6,
//    "vignette": true, "raised_m": 0}, "panel": {"onWrist": false, "frameTimes": false},
//    "sound": {"volume_percent": 100}, "hands": {"leftHanded": false, "hints": true},
//    "hold": {"upright": true, "snapsToFloor": true, "stepsHeading": false, "stepsPlace": false},
//    "brush": {"tip": "ball", "does": "paint", "radius_m": 0.06, "colour": {"red": 0.9, "green": 0.25,
//    "blue": 0.1}, "opacity": 1, "wholeClip": true, "byRay": false}, "room": {"shown": false}}
//
// Every member may be missing. Members that this program does not know stay in the file.
#pragma once

#include "editor/preference_file.h"
#include "tools/headset/hands/performer_grab.h"
#include "tools/headset/state/headset_state.h"

namespace neuvv::headset {

class HeadsetSettings {
  public:
    // With an empty `path`, load() and save() do nothing.
    explicit HeadsetSettings(std::filesystem::path path) : path_(std::move(path)) {}

    // Sets all members that the file has. Invalid members keep their defaults, and a notice of the editor names them;
    // save() replaces them in the file.
    void load(HeadsetState& state, PerformerGrabSettings& grab);
    // Writes the file where a setting has changed since load() or the last save(). Throws RuntimeFailure.
    void save(const HeadsetState& state, const PerformerGrabSettings& grab);

  private:
    static nlohmann::ordered_json to_json(const HeadsetState& state, const PerformerGrabSettings& grab,
                                          nlohmann::ordered_json base);
    std::filesystem::path path_;
    nlohmann::ordered_json document_ = nlohmann::ordered_json::object(), saved_;  // as read; as last read or saved
};

}  // namespace neuvv::headset
