// What both hands do to a stage in a frame: they point, select, hold, walk, paint, and press the panel.
#pragma once

#include "tools/headset/brush_hand.h"
#include "tools/headset/holding.h"
#include "tools/headset/walking.h"

namespace neuvv::headset {

constexpr glm::dvec2 kPanel_m{0.72, 0.54}, kWristPanel_m{0.36, 0.27};
// The panel in the world; X to its right, Y to its top.
struct PanelStand {
    xr::Pose world;
    glm::dvec2 size_m = kPanel_m;

    // World; of a place in 0..1 from the upper left.
    glm::dvec3 at(glm::dvec2 place) const {
        return world * glm::dvec3((place.x - 0.5) * size_m.x, (0.5 - place.y) * size_m.y, 0);
    }
};

// A mouse, as a hand is one on the panel.
struct PanelPointer {
    std::optional<glm::dvec2> at;  // 0..1 from the upper left; none: nobody points at it
    bool pressed = false;
    double wheel = 0;
};

class Interaction {
  public:
    // `jobs` must outlive it, or be stopped before.
    explicit Interaction(JobQueue& jobs) : brush(jobs) {}

    Hands hands;
    Holding holding;
    Walking walking;
    BrushHand brush;
    std::optional<PanelStand> panel;  // while it is shown

    // A frame: `on.time` is of its time, and is changed where hands hold something. `head` in the tracking space.
    void update(OnStage& on, const xr::HandInputs& inputs, const xr::Pose& head, double dt_s);
    PanelPointer panel_pointer() const;

  private:
    void place_hands(const OnStage& on, const xr::HandInputs& inputs, double dt_s);
    void place_panel(OnStage& on, const xr::Pose& head);
    void point(const OnStage& on);
    void remember_presses();
    void press_buttons(OnStage& on);
    void select(OnStage& on);
    void change_speed(OnStage& on, Hand& hand);
    void step_through(OnStage& on, Hand& hand);
    void move_panel(const OnStage& on);
    int panel_hand_ = xr::kRight;                         // whose ray is the panel's mouse
    std::optional<std::pair<int, xr::Pose>> held_panel_;  // by which hand, and where it is in its frame
    bool panel_was_shown_ = false, panel_was_on_wrist_ = false;
};

// A copy stands beside the one that is selected, and is selected then.
void duplicate_selected(OnStage& on);
void delete_selected(OnStage& on);

}  // namespace neuvv::headset
