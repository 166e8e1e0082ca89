// What both hands do to a stage in a frame: they point, select, grab, move the user, paint, and press the panel.
#pragma once

#include "tools/headset/hands/hand_painter.h"
#include "tools/headset/hands/light_hands.h"
#include "tools/headset/hands/locomotion.h"
#include "tools/headset/hands/performer_grab.h"
#include "tools/headset/hands/pointing.h"

namespace neuvv::headset {

// The pointer ray of a hand, as a mouse on the panel.
struct PanelPointer {
    std::optional<glm::dvec2> uv;  // 0..1 from the upper left; empty while no ray hits the panel
    bool pressed = false;
    double wheel = 0;
};

// Which buttons of a hand the user has used since the program began.
struct UsedButtons {
    bool select = false, grab = false, stick = false, menu = false, play = false, undo = false, duplicate = false;
    bool any() const { return select || grab || stick || menu || play || undo || duplicate; }
};

class Interaction {
  public:
    // `jobs` must outlive this object, or be stopped before it is destroyed.
    explicit Interaction(JobQueue& jobs) : painter(jobs) {}

    Hands hands;
    PerformerGrab grab;
    Locomotion locomotion;
    LightHands lights;
    HandPainter painter;
    std::optional<PanelPlacement> panel;               // while it is visible
    std::array<UsedButtons, xr::kHands> used_buttons;  // by role

    // Does what the hands do in a frame. `state.evaluated` is of the frame's time; a grab changes it. `head` is in the
    // tracking space. `find_surfaces` is as for point().
    void update(HeadsetState& state, const xr::HandInputs& inputs, const xr::Pose& head, double dt_s,
                const FindSurfaces& find_surfaces = {});
    PanelPointer panel_pointer() const;
    // Whether a hand holds or aims something, which edits of others must not renumber.
    bool is_holding() const { return grab.is_active() || lights.is_active(); }
    // Ends what hands have begun to do to the stage; the edits are made.
    void release_all(HeadsetState& state);
    // To be called where something else than the hands has moved the user: ends what hands have begun, and brings the
    // panel along.
    void user_was_moved(HeadsetState& state);

  private:
    void update_hands(const HeadsetState& state, const xr::HandInputs& inputs, double dt_s);
    void note_used_buttons(int which);
    void update_panel(HeadsetState& state, const xr::Pose& head);
    void track_presses();
    void handle_buttons(HeadsetState& state);
    void select(HeadsetState& state);
    void change_speed(HeadsetState& state, Hand& hand);
    void step_through(HeadsetState& state, Hand& hand);
    void move_panel(const HeadsetState& state);
    editor::SetSurface set_;         // while the tool kLights is selected
    int pointer_hand_ = xr::kRight;  // the hand whose ray is the panel's mouse
    struct PanelGrab {
        int hand = xr::kRight;
        xr::Pose hand_from_panel;
    };
    std::optional<PanelGrab> panel_grab_;
    bool panel_was_visible_ = false, panel_was_on_wrist_ = false;  // in the frame before
};

}  // namespace neuvv::headset
