// What both hands do to a stage in a frame: they point, select, grab, move the user, paint, and press the panel.
#pragma once

#include "tools/headset/hand_painter.h"
#include "tools/headset/locomotion.h"
#include "tools/headset/performer_grab.h"

namespace neuvv::headset {

constexpr glm::dvec2 kPanel_m{0.72, 0.54}, kWristPanel_m{0.36, 0.27};
struct PanelPlacement {
    xr::Pose world_from_panel;  // the origin is the panel's middle; X to its right, Y to its top
    glm::dvec2 size_m = kPanel_m;

    // The world position of a point of the panel, which is given as 0..1 from the upper left.
    glm::dvec3 point_at(glm::dvec2 uv) const {
        return world_from_panel * glm::dvec3((uv.x - 0.5) * size_m.x, (0.5 - uv.y) * size_m.y, 0);
    }
};

// The pointer ray of a hand, as a mouse on the panel.
struct PanelPointer {
    std::optional<glm::dvec2> uv;  // 0..1 from the upper left; empty while no ray hits the panel
    bool pressed = false;
    double wheel = 0;
};

class Interaction {
  public:
    // `jobs` must outlive this object, or be stopped before it is destroyed.
    explicit Interaction(JobQueue& jobs) : painter(jobs) {}

    Hands hands;
    PerformerGrab grab;
    Locomotion locomotion;
    HandPainter painter;
    std::optional<PanelPlacement> panel;  // while it is visible

    // Does what the hands do in a frame. `state.evaluated` is of the frame's time; a grab changes it. `head` is in the
    // tracking space.
    void update(HeadsetState& state, const xr::HandInputs& inputs, const xr::Pose& head, double dt_s);
    PanelPointer panel_pointer() const;

  private:
    void update_hands(const HeadsetState& state, const xr::HandInputs& inputs, double dt_s);
    void update_panel(HeadsetState& state, const xr::Pose& head);
    void cast_rays(const HeadsetState& state);
    void track_presses();
    void handle_buttons(HeadsetState& state);
    void select(HeadsetState& state);
    void change_speed(HeadsetState& state, Hand& hand);
    void step_through(HeadsetState& state, Hand& hand);
    void move_panel(const HeadsetState& state);
    int pointer_hand_ = xr::kRight;  // the hand whose ray is the panel's mouse
    struct PanelGrab {
        int hand = xr::kRight;
        xr::Pose hand_from_panel;
    };
    std::optional<PanelGrab> panel_grab_;
    bool panel_was_visible_ = false, panel_was_on_wrist_ = false;  // in the frame before
};

// Edits the document: adds a copy beside the selected node and selects the copy.
void duplicate_selected(HeadsetState& state);
// Edits the document: removes the selected node, unless it is locked.
void delete_selected(HeadsetState& state);

}  // namespace neuvv::headset
