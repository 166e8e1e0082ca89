// Grabbing performers: one hand moves and turns a performer, two hands scale it, too. While it is grabbed, only the
// evaluated stage has its new transform; the edit of the document is made when the last hand releases it.
#pragma once

#include <optional>

#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"
#include "xr/grab.h"

namespace neuvv::headset {

struct PerformerGrabSettings {
    bool upright = true;  // performers do not tilt
    // A performer that is released with its feet less than kSnapDistance_m above the floor, or less than
    // kSunkDistance_m below it, is put on the floor. So is one that stood on the floor before, where the hands scaled
    // it but lifted it by less than kSnapDistance_m. Its feet are the bottom of what is solid of it at this time.
    bool snaps_to_floor = true;
    // While a performer is grabbed, its heading is a multiple of kHeadingStep_rad, and its position on the floor, which
    // is that of its node, a multiple of kPlaceStep_m along the world's X and Z.
    bool steps_heading = false, steps_place = false;
};
constexpr double kHeadingStep_rad = glm::radians(15.0), kPlaceStep_m = 0.25;
constexpr double kSnapDistance_m = 0.15, kSunkDistance_m = 0.6;

class PerformerGrab {
  public:
    PerformerGrabSettings settings;

    // Starts, moves and ends the grab by the buttons and poses of this frame. Changes `state.evaluated`, and so has to
    // be called before it is drawn.
    void update(HeadsetState& state, Hands& hands, double dt_s);
    // Ends the grab: an edit moves the performer to where it is now. To be called before other edits, and before a
    // session ends.
    void release(HeadsetState& state);
    bool is_grabbing(int hand) const { return grab_ && grab_->is_attached(hand); }
    bool is_active() const { return grab_.has_value(); }
    // The distance from a hand that is grabbing to the point that it grabbed.
    double distance_m(int hand) const { return grab_->distance_m(hand); }

  private:
    void start(HeadsetState& state, Hand& hand, int which);
    glm::dmat4 moved() const;
    glm::dmat4 snapped(const HeadsetState& state, const glm::dmat4& world_from_node) const;
    std::optional<xr::Grab> grab_;
    uint32_t node_ = 0;
    glm::dmat4 start_transform_{1};  // world from node, when the first hand grabbed it
    glm::dvec3 start_point_{0};      // world: the point that the first hand grabbed
};

}  // namespace neuvv::headset
