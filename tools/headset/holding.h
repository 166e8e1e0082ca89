// Holding performers: a grip takes what its hand points at; one hand moves and turns it, two scale it, too. It stands
// where the hands hold it without an edit; letting go is one.
#pragma once

#include <optional>

#include "tools/headset/hand.h"
#include "tools/headset/on_stage.h"
#include "xr/grab.h"

namespace neuvv::headset {

struct HoldSettings {
    bool upright = true;  // performers do not tilt
    // Let go within kSnap_m of it or below it they stand on it; and so do those that stood on it before, where they
    // were scaled, but not lifted by more than that.
    bool snaps_to_floor = true;
};
constexpr double kSnap_m = 0.15;

class Holding {
  public:
    HoldSettings settings;

    // Takes, moves, lets go, by what the hands press this frame. Before the time is shown: it changes it.
    void update(OnStage& on, Hands& hands, double dt_s);
    // What is held is put down where it is, as an edit; before others edit, and before a session ends.
    void put_down(OnStage& on);
    bool holds(int hand) const { return grab_ && grab_->is_attached(hand); }
    bool any() const { return grab_.has_value(); }
    // Along the hand's ray to where it holds it.
    double distance_m(int hand) const { return grab_->distance_m(hand); }

  private:
    void take(OnStage& on, Hand& hand, int which);
    glm::dmat4 snapped(const OnStage& on, const glm::dmat4& world_from_node) const;
    std::optional<xr::Grab> grab_;
    uint32_t node_ = 0;
    glm::dmat4 taken_from_{1};  // world from node
    glm::dvec3 taken_at_{0};    // world: where the first hand took it
};

// An edit: the node stands there.
void stand_at(OnStage& on, uint32_t node, const glm::dmat4& world_from_node);

}  // namespace neuvv::headset
