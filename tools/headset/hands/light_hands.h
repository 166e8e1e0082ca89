// What hands do to lights and cameras while the tool kLights is selected: the trigger selects the one that the ray
// meets, and aims the selected one at what the ray meets; the grip moves and turns it, while its stick pushes and pulls
// it and, sideways, changes its opening. Meanwhile only the evaluated stage shows it; the edit of the document is made
// when the hand lets go.
#pragma once

#include <optional>

#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"
#include "tools/headset/state/opening.h"
#include "xr/grab.h"

namespace neuvv::headset {

class LightHands {
  public:
    // Selects, aims and moves by the buttons and poses of this frame. Changes `state.evaluated`, and so has to be
    // called before it is drawn.
    void update(HeadsetState& state, Hands& hands, double dt_s);
    // Ends what a hand has begun: an edit leaves the light or camera as it is now. To be called before other edits, and
    // before a session ends.
    void release(HeadsetState& state);
    bool is_active() const { return held_ || aim_; }
    bool is_holding(int hand) const { return held_ && held_->hand == hand; }
    // The distance from the hand that holds something to the point that it holds.
    double distance_m() const { return held_->grab.distance_m(held_->hand); }
    // What the thing that is held opens to now; nullopt where nothing is held, or it has no opening.
    std::optional<Opening> opening() const { return held_ ? held_->opening : std::nullopt; }

  private:
    struct Held {
        int hand = 0;
        uint32_t node = 0;
        xr::Grab grab;
        std::optional<Opening> opening;
        bool has_opened = false;  // the stick has changed the opening
    };
    struct Aim {
        int hand = 0;
        uint32_t node = 0;
        std::optional<glm::dvec3> at;  // world: what the ray has met last; empty: nothing yet
    };
    void press(HeadsetState& state, Hand& hand, int which);
    void start_holding(HeadsetState& state, Hand& hand, int which);
    static void open_held(Held& held, const Hand& hand, double dt_s);
    static editor::Editor::Operation set_opening_of(const Held& held);
    void show_held(HeadsetState& state, Hands& hands, double dt_s);
    void show_aim(HeadsetState& state, const Hands& hands);
    std::optional<Held> held_;
    std::optional<Aim> aim_;
};

}  // namespace neuvv::headset
