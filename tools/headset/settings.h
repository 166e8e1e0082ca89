// What a user of headsets chose, remembered between runs, as JSON in config_folder()/"headset.json".
//
//   {"comfort": {"smoothWalk": false, "smoothTurn": false, "snap_deg": 30, "turn_deg_per_s": 90, "walk_m_per_s": 1.6,
//    "vignette": true}, "panel": {"onWrist": false}, "hold": {"upright": true, "snapsToFloor": true},
//    "brush": {"tip": "ball", "does": "paint", "radius_m": 0.06, "colour": {"red": 0.9, "green": 0.25,
//    "blue": 0.1}, "opacity": 1, "wholeClip": true}}
//
// Every member may be missing. Members that are not known here stay in the file.
#pragma once

#include "editor/preference_file.h"
#include "tools/headset/holding.h"
#include "tools/headset/on_stage.h"

namespace neuvv::headset {

class HeadsetSettings {
  public:
    // Empty `path`: nothing is remembered.
    explicit HeadsetSettings(std::filesystem::path path) : path_(std::move(path)) {}

    // Sets what was chosen before. What is wrong in the file is told by the editor and has its default, which save()
    // writes over it.
    void load(OnStage& on, HoldSettings& hold);
    // Writes where something was chosen since. Throws RuntimeFailure.
    void save(const OnStage& on, const HoldSettings& hold);

  private:
    static nlohmann::ordered_json written(const OnStage& on, const HoldSettings& hold, nlohmann::ordered_json over);
    std::filesystem::path path_;
    nlohmann::ordered_json document_ = nlohmann::ordered_json::object(), before_;  // the file's; as it would be written
};

}  // namespace neuvv::headset
