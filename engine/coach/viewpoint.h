// From where errors are seen best, with what the trainer's own body hides.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coach/ghost.h"

namespace neuvv::coach {

// The angle, in radians, under which an eye (the trainer's space, metres) sees the errors: √(Σ w α² / Σ w), where α is
// the angle from a joint of the ghost to where it should be; 0 for those whose place in the trainer the body hides.
double seen_error(std::span<const JointError> errors, std::span<const BodyBone> body, const glm::dvec3& eye);

// Whether the body in its clothes lies between an eye and a point. Bones that the point is in hide it only where they
// are seen lengthwise.
bool is_hidden(const glm::dvec3& point, std::span<const BodyBone> body, const glm::dvec3& eye);

// Eyes from which a body may be looked at: all around at four heights and along the closed form's direction
// (motion/video/best_view.h), at a distance (metres) from a centre.
std::vector<glm::dvec3> candidate_eyes(std::span<const JointError> errors, const glm::dvec3& centre, double distance);

// Chooses an eye while errors change: of two that see alike the more level one. It stays where it is until another eye
// sees a quarter more for half a second.
class ViewChooser {
  public:
    // `step_s`: seconds since the last call. Returns the eye that was chosen last, nothing where there were no errors
    // yet.
    std::optional<glm::dvec3> choose(std::span<const JointError> errors, std::span<const BodyBone> body,
                                     const glm::dvec3& centre, double distance, double step_s);

  private:
    std::optional<glm::dvec3> direction_;  // unit, from the centre to the chosen eye
    double better_s_ = 0;                  // for how long another eye has been better
};

}  // namespace neuvv::coach
