// The performer's shadow on the floor of a simulated studio, under a broad lamp above: it has the floor's hue
// and no hard edge, and moves with the performer, so that no plate shows it.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"
#include "training/capture/backdrop.h"

namespace neuvv::training {

class FloorShadow {
  public:
    // What a camera in the lamp's place sees of the performer: premultiplied, row by row.
    FloorShadow(const stage::Camera& lamp, std::span<const glm::vec4> seen);

    // The share of the light that reaches a point of the floor (world, metres): 1 outside of the shadow.
    double light_at(const glm::dvec3& point) const;

  private:
    stage::Camera lamp_;
    std::vector<float> dark_;  // of the lamp's pixels, 0..1
};

// A camera with the lens of `camera` that looks down at `centre` from this distance above it (metres): the lamp.
stage::Camera lamp_above(const stage::Camera& camera, const glm::dvec3& centre, double distance);

// A clean plate with the shadow on its floor.
media::Image shaded(media::Image plate, const Backdrop& room, const stage::Camera& camera, const FloorShadow& shadow);

}  // namespace neuvv::training
