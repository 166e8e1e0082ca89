// Moving through the stage: teleporting or walking by the left stick, turning by the right one.
#pragma once

#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

class Locomotion {
  public:
    // Moves `state.rig`. `stick_free` says for each hand whether its stick has no other use in this frame. `head` is in
    // the tracking space.
    void update(HeadsetState& state, Hands& hands, const std::array<bool, xr::kHands>& stick_free, const xr::Pose& head,
                double dt_s);
    // The arc of the teleport that is being aimed; null while there is none.
    const xr::Arc* arc() const { return arc_ ? &*arc_ : nullptr; }
    // The heading in the world that the user would have there; nothing where it stays as it is.
    std::optional<double> arc_yaw() const { return arc_yaw_; }
    // How dark the image should be: its edges while the user moves smoothly, all of it after a jump.
    const xr::EyeShade& shade() const { return shade_; }
    // To be called where the user has been brought elsewhere at once: the image comes up out of black.
    void fade_in() { shade_.fade = 1; }

  private:
    void teleport(HeadsetState& state, Hand& hand, const xr::Pose& head);
    void turn(HeadsetState& state, Hand& hand, const xr::Pose& head, double dt_s);
    std::optional<xr::Arc> arc_;
    std::optional<double> arc_yaw_;
    xr::EyeShade shade_;
};

// Where a user who teleports to a point on the floor comes to stand: there, or beside the performers who stand there,
// kBesidePerformer_m from their boxes at the nearest; nullopt where there is no room beside them.
std::optional<glm::dvec3> free_landing(const HeadsetState& state, glm::dvec3 landing);
constexpr double kBesidePerformer_m = 0.35;

}  // namespace neuvv::headset
