// How notices reach a user who does not look at the panel: the last one stands on a short plate in view, and an error
// is felt in both hands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/editor.h"
#include "tools/headset/state/panel_placement.h"

namespace neuvv::headset {

class NoticePlate {
  public:
    static constexpr double kShown_s = 4, kErrorShown_s = 6;
    static constexpr size_t kLines = 3;
    // An error is two long pulses, where what succeeds is a single short one.
    static constexpr double kPulse_s = 0.12, kNextPulse_s = 0.24;

    void show(const editor::Notice& notice);
    // To be called once a frame. `panel`: where it is, while it is visible. The plate stays below the centre of the
    // view, but lags behind small turns of the head.
    void update(const xr::Pose& world_head, const std::optional<PanelPlacement>& panel, double dt_s);

    // The lines of the plate; none where there is no plate, as nothing is new, or the panel in view has the notice.
    const std::vector<std::string>& lines() const { return shown_; }
    // The plate's lower centre.
    const xr::Pose& world_from_plate() const { return world_from_plate_; }
    double line_m() const;

    // Whether an error's pulse begins in this frame, and whether one is under way, which no other pulse may replace.
    bool pulse_begins() const { return pulse_begins_; }
    bool is_pulsing() const { return error_s_ < kNextPulse_s + kPulse_s; }

  private:
    std::vector<std::string> lines_, shown_;
    double left_s_ = 0;
    bool is_new_ = false, pulse_begins_ = false;
    double yaw_rad_ = 0, pitch_rad_ = 0;
    double error_s_ = 1e9;  // since the last error
    xr::Pose world_from_plate_;
};

// The text in at most kLines lines of LabelFont::kMaxLetters letters; what does not fit ends with an ellipsis.
std::vector<std::string> plate_lines(const std::string& text);

}  // namespace neuvv::headset
